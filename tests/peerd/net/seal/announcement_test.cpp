#include "peerd/net/seal/announcement.hpp"

#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::seal::announcement_test {
namespace {

class Announcements : public testing::Test {
 protected:
  Announcements() {
    says.boot.fill(7);
    says.checkpoint = {.salt = 11, .covers = 12, .prints = {}};
    says.checkpoint.prints.fill(13);
    for (std::uint8_t i = 0; i < 3; ++i) says.names.push_back({{i, 1, 2, 3, 4, 5, 6, 7}, i});
  }
  const keys::Identity identity = keys::Identity::random();
  const keys::SymmetricKey key = announcing_key(keys::SymmetricKey::random());
  Announcement says{
      .sender = PeerId{3}, .number = 5, .sent = 1'000'000, .key = identity.public_key(), .signs_all = true};
};

TEST_F(Announcements, SayAllThatWentIn) {
  const auto sealed = seal_announcement(says, 0xC1, key, identity);
  EXPECT_EQ(std::to_integer<int>(sealed.front()), 0xC1);
  const auto opened = must(OpenedAnnouncement::open(sealed, key));
  EXPECT_TRUE(opened.is_signed());
  const Announcement& got = opened.says();
  EXPECT_EQ(got.sender, says.sender);
  EXPECT_EQ(got.boot, says.boot);
  EXPECT_EQ(got.number, 5u);
  EXPECT_EQ(got.sent, 1'000'000u);
  EXPECT_EQ(got.key, says.key);
  EXPECT_TRUE(got.signs_all);
  EXPECT_EQ(got.checkpoint.salt, 11u);
  EXPECT_EQ(got.checkpoint.covers, 12u);
  EXPECT_EQ(got.checkpoint.prints, says.checkpoint.prints);
  EXPECT_EQ(got.names, says.names);
}

TEST_F(Announcements, AreSignedByThoseWhoseTheyAre) {
  const auto opened = must(OpenedAnnouncement::open(seal_announcement(says, 0xC0, key, keys::Identity::random()), key));
  EXPECT_FALSE(opened.is_signed());
}

TEST_F(Announcements, OfAnotherSessionOrDamagedAreNone) {
  auto sealed = seal_announcement(says, 0xC0, key, identity);
  EXPECT_FALSE(OpenedAnnouncement::open(sealed, announcing_key(keys::SymmetricKey::random())));
  for (std::size_t size = 0; size < sealed.size(); ++size) {
    EXPECT_FALSE(OpenedAnnouncement::open({sealed.data(), size}, key)) << size;
  }
  sealed[2] ^= std::byte{1};
  EXPECT_FALSE(OpenedAnnouncement::open(sealed, key));
}

TEST_F(Announcements, HaveRoomForSoManyNames) {
  says.names.assign(1000, {});
  const auto sealed = seal_announcement(says, 0xC0, key, identity);
  EXPECT_LE(sealed.size(), kAnnouncementMax_bytes);
  EXPECT_EQ(OpenedAnnouncement::open(sealed, key)->says().names.size(), kNamesMax);
}

}  // namespace
}  // namespace peerd::seal::announcement_test
