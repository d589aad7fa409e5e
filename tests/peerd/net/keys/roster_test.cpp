#include "peerd/net/keys/roster.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/must.hpp"

namespace peerd::keys::roster_test {
namespace {

using testing::HasSubstr;

class Rosters : public testing::Test {
 protected:
  const Identity anna = Identity::random(), bo = Identity::random(), cy = Identity::random();
  const Roster begun = Roster::first("town", "anna", anna);
  [[nodiscard]] Roster with_bo(Role role = Role::kEditor) const {
    return begun.with({"bo", role, bo.public_key()}, anna).value();
  }
  static std::string refusal(const std::expected<Roster, std::string>& roster) { return roster ? "" : roster.error(); }
};

TEST_F(Rosters, GiveEachMemberTheKeyOfTheEpochAndNobodyElse) {
  const Roster two = with_bo();
  ASSERT_TRUE(begun.session_key(anna) && two.session_key(anna) && two.session_key(bo));
  EXPECT_EQ(*two.session_key(anna), *two.session_key(bo));
  EXPECT_NE(*two.session_key(anna), *begun.session_key(anna)) << "of each epoch another one";
  EXPECT_FALSE(begun.session_key(bo));
  EXPECT_FALSE(two.session_key(cy));
  EXPECT_EQ(begun.epoch(), 1u);
  EXPECT_EQ(two.epoch(), 2u);
}

TEST_F(Rosters, ARemovedMemberHasNoKeyAnyMoreAndWhatItDidStays) {
  const Roster two = with_bo(), one = two.without("bo", anna).value();
  EXPECT_FALSE(one.session_key(bo));
  EXPECT_FALSE(one.has_member(bo.public_key()));
  EXPECT_TRUE(one.may_write(bo.public_key())) << "its operations of before";
  EXPECT_NE(*one.session_key(anna), *two.session_key(anna));
  EXPECT_THAT(refusal(one.with({"bo", Role::kEditor, bo.public_key()}, anna)), HasSubstr("has a new key"));
  EXPECT_TRUE(one.with({"bo", Role::kEditor, cy.public_key()}, anna)) << "with another key it is another";
}

TEST_F(Rosters, ObserversMayNotWrite) {
  const Roster two = with_bo(Role::kObserver);
  EXPECT_TRUE(two.has_member(bo.public_key()));
  EXPECT_FALSE(two.may_write(bo.public_key()));
  EXPECT_FALSE(two.may_write(cy.public_key()));
}

TEST_F(Rosters, OnlyAdministratorsChangeThem) {
  const Roster two = with_bo();
  EXPECT_THAT(refusal(two.without("anna", bo)), HasSubstr("no administrator"));
  EXPECT_THAT(refusal(two.with({"cy", Role::kEditor, cy.public_key()}, cy)), HasSubstr("no administrator"));
  EXPECT_THAT(refusal(two.without("anna", anna)), HasSubstr("nobody would be"));
  EXPECT_THAT(refusal(two.without("cy", anna)), HasSubstr("no member cy"));
  EXPECT_THAT(refusal(two.with({"bo", Role::kEditor, cy.public_key()}, anna)), HasSubstr("there is a member bo"));
  EXPECT_THAT(refusal(two.with({"c y", Role::kEditor, cy.public_key()}, anna)), HasSubstr("no name"));
  EXPECT_THAT(refusal(two.with({"cy", Role::kEditor, PublicKey()}, anna)), HasSubstr("no key"));
}

TEST_F(Rosters, AreWhatTheirTextSays) {
  const Roster roster = with_bo(Role::kAdministrator).without("anna", bo).value();
  const auto read = must(Roster::of_text(roster.text()));
  EXPECT_EQ(read.text(), roster.text());
  EXPECT_EQ(read.world(), "town");
  EXPECT_EQ(read.epoch(), 3u);
  ASSERT_EQ(read.members().size(), 2u);
  EXPECT_TRUE(read.members()[0].is_former);
  EXPECT_EQ(read.session_key(bo), *roster.session_key(bo));
}

TEST_F(Rosters, NoChangedTextIsOne) {
  const std::string text = with_bo().text();
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string changed = text;
    changed[at] ^= 1;
    EXPECT_FALSE(Roster::of_text(changed)) << at;
  }
  for (std::size_t size = 0; size < text.size(); ++size) EXPECT_FALSE(Roster::of_text(text.substr(0, size))) << size;
  EXPECT_FALSE(Roster::of_text(text + "\n"));
  EXPECT_FALSE(Roster::of_text(text + text));
}

TEST_F(Rosters, AreFollowedByThoseOfTheirAdministrators) {
  const Roster two = with_bo(), three = two.with({"cy", Role::kAdministrator, cy.public_key()}, anna).value();
  EXPECT_TRUE(begun.is_followed_by(two));
  EXPECT_TRUE(begun.is_followed_by(three)) << "who was away";
  EXPECT_FALSE(two.is_followed_by(begun));
  EXPECT_FALSE(two.is_followed_by(two));
  EXPECT_FALSE(begun.is_followed_by(Roster::first("town", "anna", anna)
                                        .with({"bo", Role::kEditor, bo.public_key()}, anna)
                                        ->with({"x", Role::kAdministrator, cy.public_key()}, anna)
                                        ->without("anna", cy)
                                        .value()))
      << "by somebody who was no administrator here";
  const Roster elsewhere =
      Roster::first("city", "anna", anna).with({"bo", Role::kEditor, bo.public_key()}, anna).value();
  EXPECT_FALSE(begun.is_followed_by(elsewhere));
  const Roster bos = Roster::first("town", "bo", bo).with({"cy", Role::kEditor, cy.public_key()}, bo).value();
  EXPECT_FALSE(begun.is_followed_by(bos)) << "anybody can sign a roster of their own";
}

}  // namespace
}  // namespace peerd::keys::roster_test
