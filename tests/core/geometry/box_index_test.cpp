#include "core/geometry/box_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

namespace peerd::box_index_test {

struct Box {
  Vec3 low, high;
};

std::vector<std::uint32_t> found(const BoxIndex& index, const Box& box) {
  std::vector<std::uint32_t> numbers;
  index.for_each_near(box.low, box.high, [&](std::uint32_t number) { numbers.push_back(number); });
  std::ranges::sort(numbers);
  return numbers;
}

std::vector<std::uint32_t> overlapping(const std::map<std::uint32_t, Box>& boxes, const Box& box) {
  std::vector<std::uint32_t> numbers;
  for (const auto& [number, each] : boxes) {
    const bool overlap = (each.low.array() <= box.high.array()).all() && (box.low.array() <= each.high.array()).all();
    if (overlap) numbers.push_back(number);
  }
  return numbers;
}

// Boxes from millimetres to kilometres, of which some lie far out, come, move and go.
TEST(BoxIndex, FindsWhatOverlapsAndNothingElse) {
  std::mt19937_64 rng(7);
  const auto unit = [&] { return std::uniform_real_distribution(0.0, 1.0)(rng); };
  const auto draw = [&] {
    const double around_m = unit() < 0.1 ? 1e9 : 40.0;
    const double size_m = std::pow(10.0, -3.0 + (unit() < 0.1 ? 6.0 : 4.0) * unit());
    const Vec3 center = around_m * (Vec3(unit(), unit(), unit()) - Vec3::Constant(0.5));
    const Vec3 half = size_m * Vec3(unit(), unit(), unit());
    return Box{center - half, center + half};
  };
  BoxIndex index;
  std::map<std::uint32_t, Box> boxes;
  std::size_t all = 0;
  for (int step = 0; step < 4000; ++step) {
    const auto number = static_cast<std::uint32_t>(rng() % 300);
    if (boxes.contains(number) && unit() < 0.3) {
      index.erase(number);
      boxes.erase(number);
    } else {
      const Box box = draw();
      index.set(number, box.low, box.high);
      boxes[number] = box;
    }
    const Box asked = draw();
    const auto expected = overlapping(boxes, asked);
    ASSERT_EQ(found(index, asked), expected) << "step " << step;
    all += expected.size();
    ASSERT_EQ(index.size(), boxes.size());
  }
  EXPECT_GT(all, 1000U);
}

TEST(BoxIndex, HasBoxesWithoutEndAndWithoutSize) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BoxIndex index;
  index.set(3, Vec3(1, 2, 3), Vec3(1, 2, 3));
  index.set(5, Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity));
  index.set(6, Vec3::Constant(1e300), Vec3::Constant(1.5e300));
  EXPECT_EQ(found(index, {Vec3(1, 2, 3), Vec3(9, 9, 9)}), (std::vector{3U, 5U})) << "what touches is near";
  EXPECT_EQ(found(index, {Vec3::Constant(1.2e300), Vec3::Constant(1.3e300)}), (std::vector{5U, 6U}));
  EXPECT_EQ(found(index, {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)}), (std::vector{3U, 5U, 6U}));
  index.erase(5);
  EXPECT_EQ(found(index, {Vec3(2, 2, 3), Vec3(9, 9, 9)}), std::vector<std::uint32_t>{});
}

}  // namespace peerd::box_index_test
