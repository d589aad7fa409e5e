#include "peerd/net/keys/invitation.hpp"

#include <gtest/gtest.h>

namespace peerd::keys {
namespace {

TEST(Invitations, HaveTheWorldAndItsKey) {
  for (const std::string& world :
       {std::string("town"), std::string("a world, \"named\" \u00f6ddly/.."), std::string(255, 'w')}) {
    const SymmetricKey key = SymmetricKey::random();
    const std::string text = text_of(world, key);
    EXPECT_EQ(text.find_first_of(" \t\n\"'"), std::string::npos) << "it can be pasted anywhere: " << text;
    const auto read = read_invitation(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(read->world, world);
    ASSERT_TRUE(read->key);
    EXPECT_EQ(*read->key, key);
    EXPECT_FALSE(read->roster);
  }
}

TEST(Invitations, HaveTheRosterOfAWorldThatHasOne) {
  const Identity anna = Identity::random();
  const Roster roster = Roster::first("town", "anna", anna);
  const std::string text = text_of(roster);
  EXPECT_EQ(text.find_first_of(" \t\n\"'"), std::string::npos);
  const auto read = read_invitation(text);
  ASSERT_TRUE(read && read->roster);
  EXPECT_EQ(read->world, "town");
  EXPECT_FALSE(read->key);
  EXPECT_EQ(read->roster->text(), roster.text());
  EXPECT_FALSE(read_invitation(text.substr(0, text.size() - 4)));
}

TEST(Invitations, AreNoticedWhereTheyAreNotWhole) {
  const std::string text = text_of("town", SymmetricKey::random());
  for (std::size_t size = 0; size < text.size(); ++size) EXPECT_FALSE(read_invitation(text.substr(0, size))) << size;
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string changed = text;
    changed[at] = changed[at] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(read_invitation(changed)) << at;
  }
  EXPECT_FALSE(read_invitation(text + "A"));
  for (const char* const world : {"", "two\nlines", "\x1b[2J", "a\u009b1m", "\x7f", "\xff"}) {
    EXPECT_FALSE(read_invitation(text_of(world, SymmetricKey::random()))) << "it would be written to terminals";
  }
  EXPECT_FALSE(read_invitation(text_of(std::string(256, 'w'), SymmetricKey::random())));
  EXPECT_FALSE(read_invitation(SymmetricKey::random().text()));
}

}  // namespace
}  // namespace peerd::keys
