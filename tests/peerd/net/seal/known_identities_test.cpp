#include "peerd/net/seal/known_identities.hpp"

#include <gtest/gtest.h>

namespace peerd::seal {
namespace {

using namespace std::chrono_literals;
using testing::Test;

class Known : public Test {
 protected:
  const keys::PublicKey own = keys::Identity::random().public_key(), other = keys::Identity::random().public_key();
  KnownIdentities known{PeerId{1}, own};
  HostTime now{100s};
};

TEST_F(Known, NumbersBelongToTheirKeys) {
  EXPECT_EQ(known.key_of(PeerId{1}), own);
  EXPECT_FALSE(known.key_of(PeerId{2}));
  ASSERT_TRUE(known.bind(PeerId{2}, other, now));
  EXPECT_EQ(known.key_of(PeerId{2}), other);
}

TEST_F(Known, WhoWasHereForAMomentIsForgotten) {
  ASSERT_TRUE(known.bind(PeerId{2}, other, now) && known.bind(PeerId{3}, other, now));
  now += 30s;
  known.note_heard(PeerId{3}, now);
  EXPECT_TRUE(known.take_forgotten(now).empty());
  now += 31s;
  EXPECT_EQ(known.take_forgotten(now), std::vector{PeerId{2}});
  EXPECT_FALSE(known.key_of(PeerId{2}));
  now += std::chrono::hours(24 * 365);
  EXPECT_TRUE(known.take_forgotten(now).empty()) << "who was here for long, and this peer itself, stay";
  EXPECT_EQ(known.size(), 2u);
}

TEST_F(Known, TheSilentMakeRoom) {
  std::uint32_t id = 2;
  for (; known.size() < KnownIdentities::kMost; ++id) ASSERT_TRUE(known.bind(PeerId{id}, other, now));
  EXPECT_FALSE(known.bind(PeerId{id}, other, now)) << "all are heard at present";
  now += 11s;
  known.note_heard(PeerId{2}, now);
  ASSERT_TRUE(known.bind(PeerId{id}, other, now));
  EXPECT_EQ(known.size(), KnownIdentities::kMost - KnownIdentities::kMost / 4 + 1);
  EXPECT_TRUE(known.key_of(PeerId{1}) && known.key_of(PeerId{2}));
  EXPECT_EQ(known.take_forgotten(now).size(), KnownIdentities::kMost / 4);
}

TEST_F(Known, RecordsOfForgottenBootsAreTold) {
  const BootId boot{7};
  EXPECT_FALSE(known.is_record(PeerId{2}, boot, 1));
  known.note_boot(PeerId{2}, boot, 5);
  EXPECT_TRUE(known.is_record(PeerId{2}, boot, 5));
  EXPECT_FALSE(known.is_record(PeerId{2}, boot, 6));
  for (std::uint32_t i = 0; i < KnownIdentities::kForgottenMax; ++i) known.note_boot(PeerId{1000 + i}, boot, 5);
  EXPECT_FALSE(known.is_record(PeerId{2}, boot, 5)) << "the oldest made room";
}

}  // namespace
}  // namespace peerd::seal
