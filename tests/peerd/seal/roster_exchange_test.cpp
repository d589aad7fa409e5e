#include "peerd/seal/roster_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "peerd/seal/sealer.hpp"

namespace peerd::seal::roster_exchange_test {
namespace {

using Bytes = std::vector<std::byte>;

class RosterExchanges : public testing::Test {
 protected:
  // Someone announces itself in the epoch of a roster.
  Bytes announcement(const Roster& roster, const Identity& who) {
    Sealer sealer(roster.session_key(who).value(),
                  {.peer = PeerId{7}, .identity = who, .epoch = epoch_bits(roster.epoch())});
    return sealer.announcement_due(now).value();
  }
  HostTime now{std::chrono::seconds(5)};
  const Identity anna = Identity::random(), bo = Identity::random(), cy = Identity::random();
  const Roster one = Roster::first("town", "anna", anna).with({"bo", Role::kEditor, bo.public_key()}, anna).value();
  const Roster two = one.with({"cy", Role::kEditor, cy.public_key()}, anna).value();
};

TEST_F(RosterExchanges, BringTheNewestToWhoHasAnOlderOne) {
  RosterExchange newer(two, {one}, anna), older(one, {}, bo);
  const auto parts = newer.answer(announcement(one, bo), now);
  ASSERT_FALSE(parts.empty());
  std::optional<Roster> got;
  for (const Bytes& part : parts) {
    EXPECT_TRUE(RosterExchange::is_part(part) && older.opens(part));
    EXPECT_FALSE(newer.opens(part)) << "it is for the epoch before";
    EXPECT_FALSE(Sealer::is_announcement(part));
    EXPECT_LE(part.size(), kAnnouncementMax_bytes);
    if (auto whole = older.take(part)) got = std::move(whole);
  }
  ASSERT_TRUE(got);
  EXPECT_EQ(got->text(), two.text());
  ASSERT_TRUE(older.adopt(*got));
  EXPECT_EQ(*older.key(), *newer.key());
  EXPECT_TRUE(newer.answer(announcement(one, bo), now).empty()) << "not again at once";
  EXPECT_FALSE(newer.answer(announcement(one, bo), now + RosterExchange::kApart).empty());
}

TEST_F(RosterExchanges, PartsMayComeInAnyOrderAndSomeTwice) {
  Roster many = two;
  for (int i = 0; i < 20; ++i) {
    many = many.with({"m" + std::to_string(i), Role::kObserver, Identity::random().public_key()}, anna).value();
  }
  RosterExchange newer(many, {one}, anna), older(one, {}, bo);
  auto parts = newer.answer(announcement(one, bo), now);
  ASSERT_GT(parts.size(), 3u);
  std::ranges::reverse(parts);
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) EXPECT_FALSE(older.take(parts[i]));
  EXPECT_FALSE(older.take(parts[0]));
  EXPECT_TRUE(older.take(parts.back()));
}

TEST_F(RosterExchanges, NothingIsSaidToStrangersNorOfTheSameEpoch) {
  RosterExchange newer(two, {one}, anna);
  EXPECT_TRUE(newer.answer(announcement(two, bo), now).empty());
  const Roster others = Roster::first("town", "x", cy);
  EXPECT_TRUE(newer.answer(announcement(others, cy), now).empty());
  Bytes damaged = announcement(one, bo);
  damaged[40] ^= std::byte{1};
  EXPECT_TRUE(newer.answer(damaged, now).empty());
  EXPECT_TRUE(newer.answer({}, now).empty());
}

// A member that was removed learns that, and nothing else: the next epoch's key is in no box for it.
TEST_F(RosterExchanges, ARemovedMemberLearnsThat) {
  const Roster without = two.without("bo", anna).value();
  RosterExchange newer(without, {one, two}, anna), removed(two, {}, bo);
  std::optional<Roster> got;
  for (const Bytes& part : newer.answer(announcement(two, bo), now)) got = removed.take(part);
  ASSERT_TRUE(got);
  ASSERT_TRUE(removed.adopt(*got));
  EXPECT_FALSE(removed.key());
}

TEST_F(RosterExchanges, ForgedPartsAndOlderRostersAreNotTaken) {
  RosterExchange newer(two, {one}, anna), older(one, {}, bo);
  const Bytes part = newer.answer(announcement(one, bo), now).front();
  for (std::size_t at = 0; at < part.size(); ++at) {
    Bytes changed = part;
    changed[at] ^= std::byte{1};
    EXPECT_FALSE(older.take(changed)) << at;
  }
  for (std::size_t size = 0; size < part.size(); ++size) EXPECT_FALSE(older.take({part.data(), size}));
  // A member signs a roster of its own, and sends it as the others would.
  const Roster own = Roster::first("town", "bo", bo)
                         .with({"anna", Role::kObserver, anna.public_key()}, bo)
                         .value()
                         .with({"cy", Role::kObserver, cy.public_key()}, bo)
                         .value();
  RosterExchange hostile(own, {one}, bo), honest(one, {}, anna);
  for (const Bytes& each : hostile.answer(announcement(one, anna), now)) EXPECT_FALSE(honest.take(each));
  EXPECT_FALSE(honest.adopt(own));
}

}  // namespace
}  // namespace peerd::seal::roster_exchange_test
