#include "peerd/cli/lab/measured_shape.hpp"

#include <gtest/gtest.h>

namespace peerd::measured_shape_test {

using collision::SplitRule;
using collision::TriangleSoup;

// A row of triangles along x, each a polygon of its own, between two vertices that none uses.
TriangleSoup row(std::uint32_t triangles) {
  TriangleSoup soup;
  soup.vertices.emplace_back(1e9, 1e9, 1e9);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const Vec3& corner : {Vec3(i, 0, 0), Vec3(i, 1, 0), Vec3(i, 0, 1)}) {
      soup.vertices.push_back(corner);
      soup.box.merge(corner);
    }
    soup.faces.push_back({{first, first + 1, first + 2}, i});
  }
  soup.vertices.emplace_back(-1e9, 0, 0);
  return soup;
}

TEST(OverTurns, KeepsLeastGreatestAndSum) {
  OverTurns turns;
  for (const double value : {3.0, 1.0, 2.0}) turns.add(value);
  EXPECT_EQ(turns.least, 1.0);
  EXPECT_EQ(turns.greatest, 3.0);
  EXPECT_EQ(turns.sum, 6.0);
}

// The prism around the row: half a square by its length. Vertices that no triangle uses do not count.
TEST(MeasureShape, TakesTheHullOfWhatIsUsed) {
  const MeasuredShape shape = measure_shape("ROW", row(5), 1, {}, false);
  EXPECT_EQ(shape.path, "ROW");
  EXPECT_EQ(shape.polygons, 5u);
  EXPECT_EQ(shape.vertices, 17u);
  EXPECT_EQ(shape.box.hi, Vec3(4, 1, 1));
  ASSERT_TRUE(shape.tightness);
  EXPECT_NEAR(shape.tightness->hull_m3, 2.0, 1e-12);
  EXPECT_NEAR(shape.tightness->box, 200.0, 1e-6);
  EXPECT_NEAR(shape.tightness->aabb.sum / 7, 200.0, 1e-9);
  EXPECT_NEAR(shape.tightness->kdop.sum / 7, 100.0, 1e-9) << "a face of an 18-DOP cuts the square in half";
  EXPECT_EQ(shape.tightness->turned.size(), 7u);
}

// A balanced tree of n groups has ceil(log2 n) levels below its root.
TEST(MeasureShape, LeastHeightsAreThoseOfBalancedTrees) {
  struct Case {
    std::uint32_t triangles, threshold, least;
  };
  for (const auto& [triangles, threshold, least] : {Case{1, 1, 0}, Case{2, 1, 1}, Case{3, 1, 2}, Case{4, 1, 2},
                                                    Case{5, 1, 3}, Case{16, 4, 2}, Case{17, 4, 3}, Case{5, 8, 0}}) {
    const MeasuredShape shape =
        measure_shape("", row(triangles), 1, {{.k = 6, .tree = {SplitRule::kLongestSide, threshold}}}, true);
    ASSERT_EQ(shape.hierarchies.size(), 1u);
    const MeasuredHierarchy& tree = shape.hierarchies.front();
    EXPECT_EQ(tree.least_height, least) << triangles << " by " << threshold;
    EXPECT_GE(tree.height, least);
    EXPECT_EQ(tree.level_percent.size(), tree.height + 1u);
  }
}

}  // namespace peerd::measured_shape_test
