#include "collision/broad_phase/broad_phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace peerd::collision {

void PrintTo(BroadPair pair, std::ostream* out) { *out << pair.low << '-' << pair.high; }

}  // namespace peerd::collision

namespace peerd::collision::broad_phase_test {

using Pairs = std::vector<BroadPair>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr auto kMethods = {BroadPhaseMethod::kBruteForce, BroadPhaseMethod::kSweepAndPrune,
                           BroadPhaseMethod::kDynamicTree, BroadPhaseMethod::kInterestLists};

const char* name(BroadPhaseMethod method) {
  switch (method) {
    case BroadPhaseMethod::kBruteForce:
      return "BruteForce";
    case BroadPhaseMethod::kSweepAndPrune:
      return "SweepAndPrune";
    case BroadPhaseMethod::kDynamicTree:
      return "DynamicTree";
    case BroadPhaseMethod::kInterestLists:
      return "InterestLists";
  }
  return "";
}

WorldBox box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return {Vec3(x0, y0, z0), Vec3(x1, y1, z1)};
}
WorldBox cube(double x, double y = 0, double z = 0) { return box(x, y, z, x + 1, y + 1, z + 1); }
Pairs ticked(BroadPhase& broad) {
  const auto answer = broad.tick();
  return {answer.begin(), answer.end()};
}

class EachMethod : public testing::TestWithParam<BroadPhaseMethod> {
 protected:
  std::unique_ptr<BroadPhase> broad = make_broad_phase(GetParam());
};

struct Case {
  const char* name;
  WorldBox a, b;
  bool overlap;
};
const Case kCases[] = {
    {"Inside", box(0, 0, 0, 3, 3, 3), cube(1, 1, 1), true},
    {"Apart", cube(0), cube(2), false},
    {"FaceTouches", cube(0), cube(1), true},
    {"EdgeTouches", cube(0), cube(1, 1), true},
    {"CornerTouches", cube(0), cube(1, 1, 1), true},
    {"AnUlpApart", cube(0), box(std::nextafter(1.0, 2.0), 0, 0, 2, 1, 1), false},
    {"PointOnPoint", box(1, 2, 3, 1, 2, 3), box(1, 2, 3, 1, 2, 3), true},
    {"NegativeZero", box(-1, -1, -1, -0.0, 0, 0), box(0.0, -1, -1, 1, 0, 0), true},
    {"EmptyInAll", WorldBox{}, box(-kInfinity, -kInfinity, -kInfinity, kInfinity, kInfinity, kInfinity), false},
    {"EmptyInEmpty", WorldBox{}, WorldBox{}, false},
    {"InsideOut", box(1, 0, 0, 0, 1, 1), box(-5, -5, -5, 5, 5, 5), false},
    {"NotANumber", box(std::numeric_limits<double>::quiet_NaN(), 0, 0, 1, 1, 1), box(-5, -5, -5, 5, 5, 5), false},
    {"HalfSpace", box(-kInfinity, -kInfinity, -kInfinity, 0, kInfinity, kInfinity), cube(0), true},
    {"HalfSpaceApart", box(-kInfinity, -kInfinity, -kInfinity, 0, kInfinity, kInfinity), cube(0.25), false},
    {"AtInfinity", box(kInfinity, 0, 0, kInfinity, 1, 1), box(0, 0, 0, kInfinity, 1, 1), true},
    {"BeyondBinary32", box(1e300, 0, 0, 2e300, 1, 1), box(2e300, 0, 0, 3e300, 1, 1), true},
    {"BeyondBinary32Apart", box(1e300, 0, 0, 2e300, 1, 1), box(3e300, 0, 0, 4e300, 1, 1), false},
};

TEST_P(EachMethod, KnowsWhatOverlapIs) {
  for (const Case& c : kCases) {
    for (const bool as_group : {false, true}) {
      for (const bool swapped : {false, true}) {
        for (const bool moved : {false, true}) {
          SCOPED_TRACE(std::string(c.name) + (as_group ? " group" : "") + (swapped ? " swapped" : "") +
                       (moved ? " moved" : ""));
          const auto phase = make_broad_phase(GetParam());
          phase->add(0, moved ? cube(-7) : swapped ? c.b : c.a);
          phase->add(1, moved ? cube(70) : swapped ? c.a : c.b);
          if (as_group) {
            phase->join(0, 0);
            phase->join(0, 1);
          } else {
            phase->register_interest(1, 0);
          }
          if (moved) {
            EXPECT_EQ(ticked(*phase), Pairs{});
            phase->move(0, swapped ? c.b : c.a);
            phase->move(1, swapped ? c.a : c.b);
          }
          EXPECT_EQ(ticked(*phase), c.overlap ? Pairs({{0, 1}}) : Pairs{});
        }
      }
    }
  }
}

TEST_P(EachMethod, OnlyInterestsExist) {
  for (BroadIndex i = 0; i < 4; ++i) broad->add(i, cube(0));
  EXPECT_EQ(ticked(*broad), Pairs{});
  EXPECT_TRUE(broad->register_interest(3, 1));
  EXPECT_FALSE(broad->register_interest(1, 3));
  EXPECT_EQ(ticked(*broad), Pairs({{1, 3}}));
  EXPECT_TRUE(broad->join(2, 0));
  EXPECT_TRUE(broad->join(2, 1));
  EXPECT_FALSE(broad->join(2, 1));
  EXPECT_TRUE(broad->join(2, 3));
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}, {0, 3}, {1, 3}}));
  EXPECT_TRUE(broad->leave(2, 3));
  EXPECT_FALSE(broad->leave(2, 3));
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}, {1, 3}}));  // 1-3 has another reason to be
  EXPECT_TRUE(broad->unregister_interest(3, 1));
  EXPECT_FALSE(broad->unregister_interest(3, 1));
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}}));
}

TEST_P(EachMethod, AnIndexThatIsUsedAgainHasNoOldInterests) {
  for (BroadIndex i = 0; i < 3; ++i) broad->add(i, cube(0));
  broad->register_interest(0, 1);
  broad->join(0, 1);
  broad->join(0, 2);
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}, {1, 2}}));
  broad->remove(1);
  broad->add(1, cube(0));
  EXPECT_EQ(ticked(*broad), Pairs{});
  EXPECT_TRUE(broad->register_interest(0, 1));
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}}));
}

TEST_P(EachMethod, WhatCancelsWithinATickIsNotSeen) {
  broad->add(0, cube(0));
  broad->add(1, cube(0.5));
  broad->register_interest(0, 1);
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}}));
  broad->unregister_interest(0, 1);
  broad->register_interest(0, 1);
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}}));
  broad->move(0, cube(50));
  broad->move(0, cube(0));
  EXPECT_EQ(ticked(*broad), Pairs({{0, 1}}));
  broad->unregister_interest(0, 1);
  broad->register_interest(0, 1);
  broad->unregister_interest(0, 1);
  EXPECT_EQ(ticked(*broad), Pairs{});
}

INSTANTIATE_TEST_SUITE_P(Methods, EachMethod, testing::ValuesIn(kMethods),
                         [](const auto& of) { return name(of.param); });

// Seeded walks: all methods do the same, and say the same as the twin.

enum class Load : std::uint8_t { kPairs, kGroups, kBoth };

class Walk {
 public:
  Walk(unsigned seed, Load load, double side_m) : random_(seed), load_(load), side_m_(side_m) {
    for (const auto method : kMethods) phases_.push_back(make_broad_phase(method));
  }
  void round() {
    for (int k = 0; k < 8; ++k) change();
    // Now and then everything moves, a little or on the grid, where boxes touch.
    if (below(3) == 0) {
      for (BroadIndex i = 0; i < kObjects; ++i) {
        if (there_.contains(i)) place(i, below(8) == 0 ? any_box() : stepped(i));
      }
    }
  }
  void expect_agreement() {
    const Pairs expected = ticked(*phases_.front());
    for (std::size_t m = 1; m < phases_.size(); ++m) {
      ASSERT_EQ(ticked(*phases_[m]), expected) << name(kMethods.begin()[m]);
      const auto before = phases_[m]->counters().box_tests;
      ASSERT_EQ(ticked(*phases_[m]), expected) << "again, " << name(kMethods.begin()[m]);
      ASSERT_EQ(phases_[m]->counters().box_tests, before);
    }
    found_ += expected.size();
  }
  [[nodiscard]] std::size_t found() const { return found_; }

 private:
  static constexpr BroadIndex kObjects = 60;
  unsigned below(unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random_); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  WorldBox any_box() {
    const unsigned kind = below(40);
    if (kind == 0) return {};
    if (kind == 1) return box(3, 3, 3, 2, 2, 2);
    WorldBox b;
    const bool on_grid = below(2) == 0;
    for (int i = 0; i < 3; ++i) {
      b.lo[i] = on_grid ? std::floor(uniform(0, side_m_)) : uniform(0, side_m_);
      b.hi[i] = b.lo[i] + (on_grid ? below(3) : uniform(0, 2));
      if (kind == 2 && below(2) == 0) b.lo[i] = -kInfinity;
      if (kind == 2 && below(2) == 0) b.hi[i] = kInfinity;
      if (kind == 3 && below(3) == 0) b.lo[i] = b.hi[i] = below(2) == 0 ? kInfinity : -kInfinity;
    }
    return b;
  }
  WorldBox stepped(BroadIndex i) {
    WorldBox b = boxes_[i];
    const Vec3 step(uniform(-0.2, 0.2), uniform(-0.2, 0.2), uniform(-0.2, 0.2));
    b.lo += step;
    b.hi += step;
    return b;
  }
  template <class Call>
  void all(const Call& call) {
    for (auto& phase : phases_) call(*phase);
  }
  template <class Call>
  void all_agree(const Call& call) {
    const bool expected = call(*phases_.front());
    for (std::size_t m = 1; m < phases_.size(); ++m) EXPECT_EQ(call(*phases_[m]), expected);
  }
  void place(BroadIndex i, const WorldBox& b) {
    boxes_[i] = b;
    all([&](BroadPhase& p) { p.move(i, b); });
  }
  void change() {
    const BroadIndex i = below(kObjects), j = below(kObjects);
    if (!there_.contains(i)) {
      boxes_[i] = any_box();
      all([&](BroadPhase& p) { p.add(i, boxes_[i]); });
      there_.insert(i);
      if (load_ != Load::kPairs) all_agree([&](BroadPhase& p) { return p.join(i % 3, i); });
      return;
    }
    const bool pairs = load_ != Load::kGroups, groups = load_ != Load::kPairs;
    switch (below(10)) {
      case 0:
        if (below(3) != 0) break;
        all([&](BroadPhase& p) { p.remove(i); });
        there_.erase(i);
        break;
      case 1:
        place(i, any_box());
        break;
      case 2:
        if (groups) all_agree([&, g = below(3)](BroadPhase& p) { return p.join(g, i); });
        break;
      case 3:
        if (groups) all_agree([&, g = below(3)](BroadPhase& p) { return p.leave(g, i); });
        break;
      case 4:
        if (pairs && i != j && there_.contains(j)) {
          all_agree([&](BroadPhase& p) { return p.unregister_interest(i, j); });
        }
        break;
      case 5:
        place(i, stepped(i));
        break;
      default:
        if (pairs && i != j && there_.contains(j)) all_agree([&](BroadPhase& p) { return p.register_interest(i, j); });
    }
  }

  std::mt19937 random_;
  Load load_;
  double side_m_;
  std::vector<std::unique_ptr<BroadPhase>> phases_;
  std::set<BroadIndex> there_;
  WorldBox boxes_[kObjects];
  std::size_t found_ = 0;
};

TEST(BroadPhase, EveryMethodEqualsItsTwin) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const auto load = static_cast<Load>(seed % 3);
    Walk walk(seed, load, seed % 2 == 0 ? 4 : 9);
    for (int tick = 0; tick < 150; ++tick) {
      walk.round();
      walk.expect_agreement();
      if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << ", tick " << tick;
    }
    EXPECT_GT(walk.found(), 150u) << "seed " << seed;
  }
}

// Many changes at once: sorting anew, rotations, the pass over all near pairs.
TEST(BroadPhase, EveryMethodEqualsItsTwinInACrowd) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 20), step(-0.3, 0.3);
    std::vector<std::unique_ptr<BroadPhase>> phases;
    for (const auto method : kMethods) phases.push_back(make_broad_phase(method));
    std::vector<WorldBox> boxes(400);
    for (BroadIndex i = 0; i < boxes.size(); ++i) {
      // Half of the crowds stand in line: the worst order for a tree to grow in.
      boxes[i] = seed % 2 == 0 ? cube(place(random), place(random), place(random)) : cube(i * 0.1);
      for (auto& p : phases) p->add(i, boxes[i]);
      for (auto& p : phases) p->join(0, i);
    }
    for (int tick = 0; tick < 40; ++tick) {
      const Pairs expected = ticked(*phases.front());
      ASSERT_FALSE(expected.empty());
      for (std::size_t m = 1; m < phases.size(); ++m) {
        ASSERT_EQ(ticked(*phases[m]), expected) << name(kMethods.begin()[m]) << ", seed " << seed << ", tick " << tick;
      }
      const bool few = tick % 2 == 0;
      for (BroadIndex i = 0; i < boxes.size(); ++i) {
        if (few && i % 37 != 0) continue;
        const Vec3 by(step(random), step(random), step(random));
        boxes[i].lo += by;
        boxes[i].hi += by;
        for (auto& p : phases) p->move(i, boxes[i]);
      }
    }
  }
}

class EachIncrementalMethod : public EachMethod {};

TEST_P(EachIncrementalMethod, NothingIsTestedWhereNothingMoved) {
  for (BroadIndex i = 0; i < 50; ++i) broad->add(i, cube(i * 0.6));
  for (BroadIndex i = 0; i < 25; ++i) broad->join(0, i);
  for (BroadIndex i = 25; i < 49; ++i) broad->register_interest(i, i + 1);
  const Pairs answer = ticked(*broad);
  EXPECT_EQ(answer.size(), 48u);
  const auto before = broad->counters();
  EXPECT_GT(before.box_tests, 0u);
  EXPECT_EQ(ticked(*broad), answer);
  for (BroadIndex i = 0; i < 50; ++i) broad->move(i, cube(i * 0.6));  // where they are
  EXPECT_EQ(ticked(*broad), answer);
  EXPECT_EQ(broad->counters().box_tests, before.box_tests);
  EXPECT_EQ(broad->counters().moves, before.moves);
  EXPECT_EQ(broad->counters().refits, before.refits);
}

TEST_P(EachIncrementalMethod, OneMoveCostsItsOwnNeighbours) {
  for (BroadIndex i = 0; i < 1000; ++i) broad->add(i, cube(i * 3.0));
  for (BroadIndex i = 0; i + 1 < 1000; ++i) broad->register_interest(i, i + 1);
  EXPECT_EQ(ticked(*broad), Pairs{});
  const auto before = broad->counters();
  broad->move(500, cube(500 * 3.0 + 2.0));
  EXPECT_EQ(ticked(*broad), Pairs({{500, 501}}));
  EXPECT_EQ(broad->counters().moves - before.moves, 1u);
  EXPECT_LE(broad->counters().box_tests - before.box_tests, 100u);
}

TEST_P(EachIncrementalMethod, StepsWithinAFatBoxLookForNothing) {
  for (BroadIndex i = 0; i < 3; ++i) broad->add(i, cube(i * 100.0));
  for (BroadIndex i = 0; i < 3; ++i) broad->join(0, i);
  for (int tick = 0; tick < 64; ++tick) {
    broad->move(0, cube(tick * 0.03125));
    EXPECT_EQ(ticked(*broad), Pairs{});
  }
  EXPECT_LE(broad->counters().refits, 3u + 64u / 8u + 2u);
}

INSTANTIATE_TEST_SUITE_P(Methods, EachIncrementalMethod,
                         testing::Values(BroadPhaseMethod::kSweepAndPrune, BroadPhaseMethod::kDynamicTree,
                                         BroadPhaseMethod::kInterestLists),
                         [](const auto& of) { return name(of.param); });

}  // namespace peerd::collision::broad_phase_test
