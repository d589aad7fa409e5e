#include "replication/settings/grid/region_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

namespace peerd::replication::region_grid_test {

using testing::IsEmpty;

class Random {
 public:
  explicit Random(std::uint64_t seed) : rng_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(rng_() >> 11) * 0x1p-53; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(rng_() % n); }
  Vec3 point(double far_m) { return {uniform(-far_m, far_m), uniform(-far_m, far_m), uniform(-far_m, far_m)}; }

 private:
  std::mt19937_64 rng_;
};

TEST(RegionGrid, UncutIsTheWholeScene) {
  const RegionGrid grid;
  EXPECT_FALSE(grid.cuts());
  EXPECT_EQ(grid.count(), 0u);
  EXPECT_EQ(grid.region_of({1e9, -3, 7}), kWholeScene);
  EXPECT_THAT(grid.touched({0, 0, 0}, 1e9), IsEmpty());
  EXPECT_EQ(grid.outside_m({5, 5, 5}, {0, 0, 0}), 0.0);
}

TEST(RegionGrid, EachCellOfAPeriodHasARegionOfItsOwn) {
  const RegionGrid grid(10.0, {4, 2, 3});
  EXPECT_EQ(grid.count(), 24u);
  std::set<RegionId> seen;
  for (int x = -2; x < 2; ++x) {
    for (int y = 5; y < 7; ++y) {
      for (int z = 0; z < 3; ++z) seen.insert(grid.region_of({10.0 * x + 1.0, 10.0 * y + 9.0, 10.0 * z + 5.0}));
    }
  }
  EXPECT_EQ(seen.size(), 24u);
  EXPECT_EQ(*seen.begin(), RegionId{1}) << "region 0 is the session's";
  EXPECT_EQ(*seen.rbegin(), RegionId{24});
}

TEST(RegionGrid, RegionsRepeatAndBordersBelongToTheUpperCell) {
  const RegionGrid grid(75.0, {8, 1, 8});
  const RegionId home = grid.region_of({10, 0, 10});
  EXPECT_EQ(grid.region_of({10, 1e6, 10}), home) << "heights are not cut";
  EXPECT_EQ(grid.region_of({10 + 600, 0, 10 - 600}), home);
  EXPECT_EQ(grid.region_of({0, 0, 0}), home);
  EXPECT_NE(grid.region_of({75, 0, 10}), home);
  EXPECT_NE(grid.region_of({-1e-300, 0, 10}), home);
  EXPECT_EQ(grid.region_of({1e12, 0, -1e12}), grid.region_of({1e12, 5, -1e12}));
}

// The oracle tests all cells around one by one, each with its own box.
std::set<RegionId> brute_force(const RegionGrid& grid, double cell_m, const std::array<std::uint32_t, 3>& counts,
                               const Vec3& center, double radius_m) {
  std::set<RegionId> found;
  std::array<int, 3> low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const bool cut = counts[static_cast<std::size_t>(axis)] > 1;
    low[static_cast<std::size_t>(axis)] =
        cut ? static_cast<int>(std::floor((center[axis] - radius_m) / cell_m)) - 1 : 0;
    high[static_cast<std::size_t>(axis)] =
        cut ? static_cast<int>(std::floor((center[axis] + radius_m) / cell_m)) + 1 : 0;
  }
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        const Vec3 corner = cell_m * Vec3(x, y, z);
        double distance2 = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          if (counts[static_cast<std::size_t>(axis)] == 1) continue;
          const double nearest = std::clamp(center[axis], corner[axis], corner[axis] + cell_m);
          distance2 += (center[axis] - nearest) * (center[axis] - nearest);
        }
        if (std::sqrt(distance2) <= radius_m) found.insert(grid.region_of(corner + 0.5 * Vec3::Constant(cell_m)));
      }
    }
  }
  return found;
}

TEST(RegionGrid, TouchedIsWhatOneByOneFinds) {
  Random random(1);
  for (int round = 0; round < 3000; ++round) {
    SCOPED_TRACE(round);
    const std::array<std::uint32_t, 3> counts{1 + random.below(7), 1 + random.below(4), 1 + random.below(7)};
    const double cell_m = random.uniform(1.0, 100.0);
    const RegionGrid grid(cell_m, counts);
    const Vec3 center = random.point(500.0);
    const double radius_m = random.uniform(0.0, 3.0 * cell_m);
    const auto touched = grid.touched(center, radius_m);
    EXPECT_TRUE(std::ranges::is_sorted(touched));
    const std::set<RegionId> as_set(touched.begin(), touched.end());
    EXPECT_EQ(as_set.size(), touched.size());
    EXPECT_EQ(as_set, brute_force(grid, cell_m, counts, center, radius_m));
  }
}

TEST(RegionGrid, HowFarOutsideOfItsCell) {
  const RegionGrid grid(10.0, {4, 1, 4});
  EXPECT_EQ(grid.outside_m({9.5, 77, 0.0}, {1, 0, 1}), 0.0);
  EXPECT_EQ(grid.outside_m({12, 0, 5}, {1, 0, 1}), 2.0);
  EXPECT_EQ(grid.outside_m({13, 0, -4}, {1, 0, 1}), 5.0);
  EXPECT_EQ(grid.outside_m({41, 0, 1}, {1, 0, 1}), 31.0) << "the same region, another cell";
  Random random(3);
  for (int round = 0; round < 5000; ++round) {
    const Vec3 home = random.point(200.0), there = random.point(200.0);
    const bool far = grid.region_of(home) != grid.region_of(there);
    if (far) {
      EXPECT_GT(grid.outside_m(there, home), 0.0);
    }
    // The circle around the point that just reaches the cell touches the cell's region.
    EXPECT_TRUE(
        std::ranges::binary_search(grid.touched(there, grid.outside_m(there, home) + 1e-6), grid.region_of(home)));
  }
}

}  // namespace peerd::replication::region_grid_test
