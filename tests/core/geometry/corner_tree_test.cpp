#include "core/geometry/corner_tree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace peerd::corner_tree_test {

bool is_inside(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0;
}

// Returns the corners that find() asks about, from the first place to the last.
std::set<std::uint32_t> asked(const CornerTree& tree, const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  std::set<std::uint32_t> out;
  const std::uint32_t end = tree.find(0, a, b, c, [&](std::uint32_t corner) {
    out.insert(corner);
    return false;
  });
  EXPECT_EQ(end, tree.size());
  return out;
}

class CornerTreeOfSize : public testing::TestWithParam<std::uint32_t> {};
TEST_P(CornerTreeOfSize, AsksAboutAllCornersWithinTheTriangleThatAreLeft) {
  std::mt19937 random(GetParam());
  std::uniform_int_distribution<int> grid(-20, 20);
  const auto point = [&] { return PlanePoint{static_cast<float>(grid(random)), static_cast<float>(grid(random))}; };
  std::vector<PlanePoint> points(GetParam());
  for (PlanePoint& p : points) p = point();
  CornerTree tree;
  tree.build(points);
  ASSERT_EQ(tree.size(), points.size());
  std::vector<bool> removed(points.size(), false);
  for (int round = 0; round < 200; ++round) {
    const PlanePoint a = point(), b = point(), c = point();
    if (orient2d(a, b, c) <= 0) continue;
    const std::set<std::uint32_t> found = asked(tree, a, b, c);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (removed[i]) {
        EXPECT_FALSE(found.contains(i));
      } else if (is_inside(points[i], a, b, c)) {
        EXPECT_TRUE(found.contains(i)) << i;
      }
    }
    const std::uint32_t gone = static_cast<std::uint32_t>(random()) % GetParam();
    if (!removed[gone]) tree.remove(gone);
    removed[gone] = true;
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, CornerTreeOfSize, testing::Values(3u, 32u, 33u, 500u));

TEST(CornerTree, GoesOnBehindThePlaceThatWasFound) {
  const std::vector<PlanePoint> points(100, PlanePoint{1, 1});
  CornerTree tree;
  tree.build(points);
  const PlanePoint a{0, 0}, b{4, 0}, c{0, 4};
  const auto any = [](std::uint32_t) { return true; };
  std::set<std::uint32_t> corners;
  for (std::uint32_t at = tree.find(0, a, b, c, any); at < tree.size(); at = tree.find(at + 1, a, b, c, any)) {
    corners.insert(tree.corner_at(at));
  }
  EXPECT_EQ(corners.size(), 100u);
}

}  // namespace peerd::corner_tree_test
