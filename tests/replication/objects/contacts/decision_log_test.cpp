#include "replication/objects/contacts/decision_log.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::decision_log_test {

using namespace test;

const ObjectId kCar{1}, kCube{2}, kLorry{3};

DecisionRecord decision(Duration contact, DecisionRule rule = DecisionRule::kVelocity, Duration known = 0ns) {
  DecisionRecord d;
  d.collider = kCar;
  d.collidee = kCube;
  d.contact = sim(contact);
  d.rule = rule;
  d.known = sim(known);
  return d;
}
std::vector<std::pair<Duration, PeerId>> standing(const DecisionLog& log) {
  std::vector<std::pair<Duration, PeerId>> all;
  for (const auto& e : log.entries()) {
    if (e.in_force) all.emplace_back(e.record.contact.time_since_epoch(), e.author);
  }
  return all;
}
using Standing = std::vector<std::pair<Duration, PeerId>>;

TEST(DecisionLog, ACopyChangesNothing) {
  DecisionLog log;
  ASSERT_TRUE(log.add(decision(1s), PeerId{2}));
  EXPECT_FALSE(log.add(decision(1s), PeerId{2}));
  DecisionRecord turned = decision(1s);
  std::swap(turned.collider, turned.collidee);
  EXPECT_FALSE(log.add(turned, PeerId{2}));
  EXPECT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.last(kCar), sim(1s));
  EXPECT_EQ(log.last(kLorry), SimTime{});
  EXPECT_EQ(log.last(kCube, kCar), sim(1s));
  EXPECT_NE(log.find(sim(1s), PeerId{2}, kCube, kCar), nullptr);
  EXPECT_EQ(log.find(sim(1s) + 1ns, PeerId{2}, kCube, kCar), nullptr);
  EXPECT_EQ(log.find(sim(1s), PeerId{1}, kCube, kCar), nullptr);
  EXPECT_EQ(log.find(sim(1s), PeerId{2}, kLorry, kCar), nullptr);
}

TEST(DecisionLog, DecisionsOfOneInstantStandInOneOrderHoweverTheyCame) {
  DecisionRecord other = decision(1s);
  other.collidee = kLorry;
  for (const bool other_first : {false, true}) {
    DecisionLog log;
    ASSERT_TRUE(log.add(other_first ? other : decision(1s), PeerId{2}));
    EXPECT_TRUE(log.has_another(sim(1s), PeerId{2}, kCar, other_first ? kCube : kLorry));
    EXPECT_FALSE(log.has_another(sim(1s), PeerId{2}, kCar, other_first ? kLorry : kCube));
    EXPECT_FALSE(log.has_another(sim(1s) + 1ns, PeerId{2}, kCar, ObjectId{9}));
    EXPECT_FALSE(log.has_another(sim(1s), PeerId{1}, kCar, ObjectId{9}));
    ASSERT_TRUE(log.add(other_first ? decision(1s) : other, PeerId{2}));
    EXPECT_EQ(log.entries().front().record.collidee, kCube);
    EXPECT_EQ(log.entries().back().record.collidee, kLorry);
  }
}

TEST(DecisionLog, AnotherDecidesAContactAtItsOwnInstantAlone) {
  DecisionLog log;
  ASSERT_TRUE(log.add(decision(2s), PeerId{2}));
  const auto decided = [&](Duration contact, std::uint32_t author, DecisionRule rule = DecisionRule::kVelocity) {
    return log.is_decided_by_another(sim(contact), PeerId{author}, kCube, kCar, rule);
  };
  EXPECT_TRUE(decided(2s, 3));
  EXPECT_FALSE(decided(2s, 2)) << "its own";
  EXPECT_FALSE(decided(2s, 3, DecisionRule::kId));
  EXPECT_FALSE(decided(1s, 3)) << "a later contact of the two";
  EXPECT_FALSE(decided(2s + 1ns, 3));
  EXPECT_FALSE(log.is_decided_by_another(sim(2s), PeerId{3}, kCube, kLorry, DecisionRule::kVelocity));
}

TEST(DecisionLog, TheLastThatMovesAnObjectMayNotBeTheLastOnIt) {
  DecisionLog log;
  DecisionRecord moves = decision(1s);
  moves.collidee_after.velocity = Vec3(1, 0, 0);
  ASSERT_TRUE(log.add(moves, PeerId{2}));
  ASSERT_TRUE(log.add(decision(4s), PeerId{3}));
  EXPECT_EQ(log.last(kCube), sim(4s));
  ASSERT_NE(log.last_entry(kCube), nullptr);
  EXPECT_EQ(log.last_entry(kCube)->author, PeerId{2});
  EXPECT_EQ(log.last_entry(kCar), nullptr) << "none has moved it";
  log.forget(kCube);
  EXPECT_TRUE(log.entries().empty());
}

struct Conflict {
  const char* name;
  DecisionRecord one, two;  // by peers 1 and 2
  Standing expected;
};
class Conflicts : public testing::TestWithParam<Conflict> {};
TEST_P(Conflicts, EndAlikeInEitherOrder) {
  const auto& [name, one, two, expected] = GetParam();
  for (const bool first : {true, false}) {
    DecisionLog log;
    ASSERT_TRUE(log.add(first ? one : two, PeerId{first ? 1u : 2u}));
    const auto changes = log.add(first ? two : one, PeerId{first ? 2u : 1u});
    ASSERT_TRUE(changes);
    EXPECT_EQ(standing(log), expected) << first;
    if (changes->size() == 2) {
      EXPECT_FALSE(changes->front().in_force) << "first what counts no more";
      EXPECT_TRUE(changes->back().in_force);
    }
    if (expected.size() == 1) {
      const SimTime loser = expected[0].second == PeerId{1} ? two.contact : one.contact;
      EXPECT_TRUE(log.overruled(kCar, loser));
      EXPECT_FALSE(log.overruled(kLorry, loser));
      EXPECT_EQ(log.last(kCar), sim(expected[0].first));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, Conflicts,
    testing::Values(Conflict{"TheLowerId", decision(1010ms), decision(1000ms), {{1010ms, PeerId{1}}}},
                    Conflict{"ThePolicyBeforeTheFallback",
                             decision(1s, DecisionRule::kId),
                             decision(1200ms),
                             {{1200ms, PeerId{2}}}},
                    Conflict{"TheNextCollision",
                             decision(1s),
                             decision(1200ms, DecisionRule::kVelocity, 1s),
                             {{1s, PeerId{1}}, {1200ms, PeerId{2}}}},
                    Conflict{"FarApart", decision(1s), decision(2001ms), {{1s, PeerId{1}}, {2001ms, PeerId{2}}}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(DecisionLog, DecisionsOfOnePeerFollowEachOther) {
  DecisionLog log;
  for (int i = 0; i < 5; ++i) ASSERT_EQ(log.add(decision(1s + i * 10ms), PeerId{3})->size(), 1u);
  EXPECT_EQ(standing(log).size(), 5u);
  log.forget_before(sim(1020ms));
  EXPECT_EQ(standing(log).size(), 3u);
}

// The standing decisions do not depend on the order and the number of copies, and the changes that the log reports add
// up to them.
TEST(DecisionLogProperty, WhatStandsIsAFunctionOfTheSet) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    std::vector<std::pair<DecisionRecord, PeerId>> all;
    for (int i = 0; i < 8; ++i) {
      DecisionRecord d =
          decision(1s + static_cast<int>(rng() % 5) * 400ms + i * 50ms,  // a peer says one thing of one contact

                   rng() % 3 == 0 ? DecisionRule::kId : DecisionRule::kVelocity,
                   rng() % 2 == 0 ? 0ns : Duration(1s + static_cast<int>(rng() % 40) * 50ms));
      if (rng() % 3 == 0) d.collidee = kLorry;
      all.emplace_back(d, PeerId{static_cast<std::uint32_t>(1 + rng() % 3)});
    }
    std::optional<Standing> expected;
    for (int shuffle = 0; shuffle < 6; ++shuffle) {
      std::ranges::shuffle(all, rng);
      DecisionLog log;
      std::set<std::tuple<ObjectId, SimTime, PeerId>> in_force;
      for (int copy = 0; copy < 2; ++copy) {
        for (const auto& [d, author] : all) {
          const auto changes = log.add(d, author);
          if (!changes) continue;
          for (const auto& c : *changes) {
            const std::tuple key(c.record.collidee, c.record.contact, c.author);
            EXPECT_EQ(c.in_force ? in_force.insert(key).second : in_force.erase(key) == 1, true);
          }
        }
      }
      EXPECT_EQ(in_force.size(), standing(log).size());
      if (!expected) expected = standing(log);
      EXPECT_EQ(standing(log), *expected);
    }
  }
}

}  // namespace peerd::replication::decision_log_test
