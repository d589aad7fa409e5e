#include "peerd/net/seal/roster_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "peerd/net/seal/sealer.hpp"

namespace peerd::seal::roster_exchange_test {
namespace {

using Bytes = std::vector<std::byte>;

class RosterExchanges : public testing::Test {
 protected:
  // Someone announces itself in the epoch of a roster.
  Bytes announcement(const keys::Roster& roster, const keys::Identity& who) {
    Sealer sealer(roster.session_key(who).value(),
                  {.peer = PeerId{7}, .identity = who, .epoch = epoch_bits(roster.epoch())});
    return sealer.announcement_due(now).value();
  }
  // Returns what it answers to an announcement, at once.
  static std::vector<Bytes> answer(RosterExchange& to, const Bytes& announcement, HostTime now) {
    to.hear(announcement, now);
    return to.answers(now + kLongestTurn);
  }
  static std::optional<keys::Roster> taken(RosterExchange& by, const Bytes& part) {
    return by.take(part, HostTime{}).value_or(std::nullopt);
  }
  static constexpr Duration kLongestTurn = RosterExchange::kTurn * RosterExchange::kTurns;
  HostTime now{std::chrono::seconds(5)};
  const keys::Identity anna = keys::Identity::random(), bo = keys::Identity::random(), cy = keys::Identity::random();
  const keys::Roster one =
      keys::Roster::first("town", "anna", anna).with({"bo", keys::Role::kEditor, bo.public_key()}, anna).value();
  const keys::Roster two = one.with({"cy", keys::Role::kEditor, cy.public_key()}, anna).value();
};

TEST_F(RosterExchanges, BringTheNewestToWhoHasAnOlderOne) {
  RosterExchange newer(two, {one}, anna), older(one, {}, bo);
  EXPECT_FALSE(newer.next_answer());
  const auto parts = answer(newer, announcement(one, bo), now);
  ASSERT_FALSE(parts.empty());
  std::optional<keys::Roster> got;
  for (const Bytes& part : parts) {
    EXPECT_TRUE(RosterExchange::is_part(part));
    EXPECT_FALSE(Sealer::is_announcement(part));
    EXPECT_LE(part.size(), kAnnouncementMax_bytes);
    if (auto whole = taken(older, part)) got = std::move(whole);
  }
  ASSERT_TRUE(got);
  EXPECT_EQ(got->text(), two.text());
  ASSERT_TRUE(older.adopt(*got));
  EXPECT_EQ(*older.key(), *newer.key());
  EXPECT_TRUE(answer(newer, announcement(one, bo), now + kLongestTurn).empty()) << "not again at once";
  EXPECT_FALSE(answer(newer, announcement(one, bo), now + kLongestTurn + RosterExchange::kApart).empty());
}

TEST_F(RosterExchanges, OneAnswersForAll) {
  RosterExchange first(two, {one}, anna), second(two, {one}, anna), older(one, {}, bo);
  const Bytes asking = announcement(one, bo);
  ASSERT_TRUE(first.hear(asking, now));
  ASSERT_TRUE(second.hear(asking, now));
  const HostTime turn = first.next_answer().value();
  EXPECT_GE(turn, now);
  EXPECT_LT(turn, now + kLongestTurn);
  EXPECT_TRUE(first.answers(turn - Duration{1}).empty());
  const auto parts = first.answers(turn);
  ASSERT_FALSE(parts.empty());
  EXPECT_FALSE(first.next_answer());
  for (const Bytes& part : parts) {
    EXPECT_TRUE(second.next_answer());
    EXPECT_TRUE(second.take(part, turn)) << "it is good, and none for this one";
  }
  EXPECT_FALSE(second.next_answer()) << "another has answered";
  EXPECT_TRUE(second.hear(asking, turn));
  EXPECT_FALSE(second.next_answer());
}

TEST_F(RosterExchanges, AnAnswerThatDiffersSparesNobodyHis) {
  RosterExchange honest(two, {one}, anna),
      hostile(one.with({"x", keys::Role::kEditor, cy.public_key()}, anna).value(), {one}, bo);
  const Bytes asking = announcement(one, bo);
  ASSERT_TRUE(honest.hear(asking, now));
  for (const Bytes& part : answer(hostile, asking, now)) EXPECT_TRUE(honest.take(part, now));
  EXPECT_TRUE(honest.next_answer());
}

// A former member's peer that goes on asks forever.
TEST_F(RosterExchanges, FormerMembersAreAnsweredOnceAMinute) {
  RosterExchange newer(two.without("bo", anna).value(), {one, two}, anna);
  int answers = 0;
  for (int s = 0; s < 180; ++s) {
    answers += answer(newer, announcement(two, bo), now + std::chrono::seconds(s)).empty() ? 0 : 1;
  }
  EXPECT_EQ(answers, 3);
  EXPECT_FALSE(answer(newer, announcement(two, anna), now + std::chrono::seconds(180)).empty())
      << "a member need not wait";
}

TEST_F(RosterExchanges, PartsMayComeInAnyOrderAndSomeTwice) {
  keys::Roster many = two;
  for (int i = 0; i < 20; ++i) {
    many = many.with({"m" + std::to_string(i), keys::Role::kObserver, keys::Identity::random().public_key()}, anna)
               .value();
  }
  RosterExchange newer(many, {one}, anna), older(one, {}, bo);
  auto parts = answer(newer, announcement(one, bo), now);
  ASSERT_GT(parts.size(), 3u);
  std::ranges::reverse(parts);
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) EXPECT_FALSE(taken(older, parts[i]));
  EXPECT_FALSE(taken(older, parts[0]));
  EXPECT_TRUE(taken(older, parts.back()));
}

TEST_F(RosterExchanges, NothingIsSaidToStrangersNorOfTheSameEpoch) {
  RosterExchange newer(two, {one}, anna);
  EXPECT_TRUE(answer(newer, announcement(two, bo), now).empty());
  const keys::Roster others = keys::Roster::first("town", "x", cy);
  EXPECT_TRUE(answer(newer, announcement(others, cy), now).empty());
  Bytes damaged = announcement(one, bo);
  damaged[40] ^= std::byte{1};
  EXPECT_TRUE(answer(newer, damaged, now).empty());
  EXPECT_TRUE(answer(newer, {}, now).empty());
}

// A member that was removed learns that, and nothing else: the next epoch's key is in no box for it.
TEST_F(RosterExchanges, ARemovedMemberLearnsThat) {
  const keys::Roster without = two.without("bo", anna).value();
  RosterExchange newer(without, {one, two}, anna), removed(two, {}, bo);
  std::optional<keys::Roster> got;
  const auto parts = answer(newer, announcement(two, bo), now);
  for (const Bytes& part : parts) got = taken(removed, part);
  ASSERT_TRUE(got);
  EXPECT_FALSE(removed.adopt(*got));
  EXPECT_EQ(removed.current().epoch(), two.epoch());
  EXPECT_TRUE(removed.key()) << "it goes on by itself";
  for (const Bytes& part : parts) EXPECT_FALSE(taken(removed, part)) << "it knows that by now";
}

TEST_F(RosterExchanges, ForgedPartsAndOlderRostersAreNotTaken) {
  RosterExchange newer(two, {one}, anna), older(one, {}, bo);
  const Bytes part = answer(newer, announcement(one, bo), now).front();
  for (std::size_t at = 0; at < part.size(); ++at) {
    Bytes changed = part;
    changed[at] ^= std::byte{1};
    EXPECT_EQ(older.take(changed, now), std::unexpected(Refusal::kForged)) << at;
  }
  for (std::size_t size = 0; size < part.size(); ++size) EXPECT_FALSE(older.take({part.data(), size}, now));
  // A member signs a roster of its own, and sends it as the others would.
  const keys::Roster own = keys::Roster::first("town", "bo", bo)
                               .with({"anna", keys::Role::kObserver, anna.public_key()}, bo)
                               .value()
                               .with({"cy", keys::Role::kObserver, cy.public_key()}, bo)
                               .value();
  RosterExchange hostile(own, {one}, bo), honest(one, {}, anna);
  for (const Bytes& each : answer(hostile, announcement(one, anna), now)) EXPECT_FALSE(taken(honest, each));
  EXPECT_FALSE(honest.adopt(own));
}

}  // namespace
}  // namespace peerd::seal::roster_exchange_test
