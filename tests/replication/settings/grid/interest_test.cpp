#include "replication/settings/grid/interest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace peerd::replication::interest_test {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

const RegionGrid kGrid(10.0, {8, 1, 8});  // region 1 + x + 8 z
constexpr Hysteresis kUsual{1.0, 1s};

SimTime at(double s) { return SimTime{from_seconds(s)}; }

std::vector<int> numbers(const std::vector<Interest::Change>& changes) {  // negative: left
  std::vector<int> all;
  for (const auto& c : changes)
    all.push_back(c.joined ? static_cast<int>(c.region.value) : -static_cast<int>(c.region.value));
  return all;
}

std::vector<int> go(Interest& interest, double t_s, double x, double radius_m = 2.0) {
  const Area area{{x, 0, 5}, radius_m};
  return numbers(interest.follow(at(t_s), {&area, 1}));
}

TEST(Interest, JoinsAMarginAheadAndLeavesTwoBehind) {
  Interest interest(kGrid, kUsual);
  EXPECT_THAT(go(interest, 0.0, 5.0), ElementsAre(1));
  EXPECT_THAT(go(interest, 5.0, 6.9), IsEmpty());
  EXPECT_THAT(go(interest, 5.1, 7.0), ElementsAre(2)) << "2 m of radius and 1 m of margin";
  EXPECT_THAT(go(interest, 9.0, 13.9), IsEmpty()) << "3.9 m past the border";
  EXPECT_THAT(go(interest, 9.1, 14.1), ElementsAre(-1)) << "2 m of radius and twice the margin";
  EXPECT_TRUE(interest.joined(RegionId{2}));
  EXPECT_FALSE(interest.joined(RegionId{1}));
}

TEST(Interest, StaysForAWhile) {
  Interest interest(kGrid, kUsual);
  EXPECT_THAT(go(interest, 0.0, 5.0), ElementsAre(1));
  EXPECT_THAT(go(interest, 0.5, 25.0), ElementsAre(3)) << "1 not yet left";
  EXPECT_THAT(go(interest, 0.99, 25.0), IsEmpty());
  EXPECT_THAT(go(interest, 1.0, 25.0), ElementsAre(-1));
}

TEST(Interest, AreasAddUp) {
  Interest interest(kGrid, kUsual);
  const std::vector<Area> areas{{{5, 0, 5}, 2.0}, {{5, 9, 5}, 1.0}, {{75, 0, 5}, 2.0}};
  EXPECT_THAT(numbers(interest.follow(at(0), areas)), ElementsAre(1, 8));
  EXPECT_THAT(numbers(interest.follow(at(0), {})), IsEmpty());
  EXPECT_THAT(numbers(interest.follow(at(1), {})), ElementsAre(-1, -8)) << "who wants nothing hears nothing";
}

TEST(Interest, EverythingIsAllRegions) {
  Interest interest(RegionGrid(10.0, {2, 1, 2}), kUsual);
  EXPECT_THAT(numbers(interest.follow_all(at(0))), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(numbers(interest.follow_all(at(9))), IsEmpty());
}

TEST(Interest, AfterAStepOfTimeAllStayForAWhile) {
  Interest interest(kGrid, kUsual);
  EXPECT_THAT(go(interest, 100.0, 5.0), ElementsAre(1));
  interest.restart_at(at(3.0));
  EXPECT_THAT(go(interest, 3.5, 25.0), ElementsAre(3));
  EXPECT_THAT(go(interest, 4.0, 25.0), ElementsAre(-1));
}

TEST(Interest, WithoutRegionsItReceivesEverything) {
  const Interest interest(RegionGrid(), kUsual);
  EXPECT_TRUE(interest.receives({1e9, 0, 0}));
  EXPECT_FALSE(Interest(kGrid, kUsual).receives({0, 0, 0}));
}

// The areas wander, jump and shake. The peer joins every region that its area needs, joins needless ones only within
// the hysteresis, and joins no region twice within the stay.
TEST(Interest, HoldsItsBoundsWhateverTheAreasDo) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const auto uniform = [&](double a, double b) { return a + (b - a) * static_cast<double>(rng() >> 11) * 0x1p-53; };
    const Hysteresis h{uniform(0.1, 4.0), from_seconds(uniform(0.0, 2.0))};
    Interest interest(kGrid, h);
    Area area{{0, 0, 0}, uniform(0.0, 25.0)};
    std::map<RegionId, SimTime> joined, left;
    for (int tick = 0; tick < 1500; ++tick) {
      const SimTime t = at(tick / 60.0);
      const double step_m = rng() % 100 == 0 ? 40.0 : 0.5;
      area.center += Vec3(uniform(-step_m, step_m), uniform(-9, 9), uniform(-step_m, step_m));
      for (const auto& c : interest.follow(t, {&area, 1})) {
        if (c.joined) {
          if (joined.contains(c.region)) {
            EXPECT_GE(t - joined[c.region], h.stay);
          }
          joined[c.region] = t;
        } else {
          EXPECT_GE(t - joined.at(c.region), h.stay);
        }
      }
      const auto wanted = kGrid.touched(area.center, area.radius_m + h.margin_m);
      const auto kept = kGrid.touched(area.center, area.radius_m + 2.0 * h.margin_m);
      for (const RegionId region : wanted) EXPECT_TRUE(interest.joined(region));
      for (const auto& [region, since] : interest.regions()) {
        EXPECT_TRUE(std::ranges::binary_search(kept, region) || t - since < h.stay);
      }
    }
  }
}

TEST(RegionSettings, ASessionIsThatOfOneCut) {
  RegionSettings off, a, b;
  a.cell_m = b.cell_m = 75.0;
  EXPECT_EQ(off.session_hash(77), 77u) << "as ever";
  EXPECT_NE(a.session_hash(77), 77u);
  EXPECT_EQ(a.session_hash(77), b.session_hash(77));
  b.regions[2] = 9;
  EXPECT_NE(a.session_hash(77), b.session_hash(77));
  b = a;
  b.hysteresis.margin_m = 2.0;
  EXPECT_NE(a.session_hash(77), b.session_hash(77))
      << "all grow their areas for the latest time at which an object is published";
  b = a;
  b.hysteresis.stay = 9s;
  b.lookahead = 1s;
  EXPECT_EQ(a.session_hash(77), b.session_hash(77)) << "a peer's own affair";
}

}  // namespace peerd::replication::interest_test
