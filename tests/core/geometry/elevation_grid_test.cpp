#include "core/geometry/elevation_grid.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/geometry/tessellate.hpp"
#include "tests/core/mesh_checks.hpp"

namespace peerd::elevation_grid_test {

ElevationGridGeometry grid(std::int32_t x, std::int32_t z, std::vector<float> height) {
  return {.x_dimension = x, .z_dimension = z, .height = std::move(height)};
}

// 6.17: P[i,j].x = xSpacing i, .y = height[i + j xDimension], .z = zSpacing j. Quadrilaterals are counted i + j
// (xDimension - 1); "by default, .. counterclockwise. Hence, the Y-component of the normal is positive."
TEST(ElevationGrid, OfThreeByTwo) {
  ElevationGridGeometry g = grid(3, 2, {10, 11, 12, 13, 14, 15});
  g.x_spacing = 2;
  g.z_spacing = 0.5F;
  const Mesh mesh = build_mesh(g);
  EXPECT_EQ(points_of(mesh), (Points{{0, 10, 0}, {2, 11, 0}, {4, 12, 0}, {0, 13, 0.5F}, {2, 14, 0.5F}, {4, 15, 0.5F}}));
  EXPECT_EQ(polygons_of(mesh), (Polygons{{0, 3, 4, 1}, {1, 4, 5, 2}}));
  EXPECT_TRUE(mesh.ccw);
  EXPECT_EQ(mesh_size(g), (MeshSize{2, 4}));
}

TEST(ElevationGrid, FacesUp) {
  const Mesh mesh = build_mesh(grid(4, 5, std::vector<float>(20)));
  ASSERT_EQ(mesh.polygon_count(), 12U);
  for (const auto& polygon : polygons_of(mesh)) {
    const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(polygon[i])]; };
    EXPECT_EQ((at(1) - at(0)).cross(at(2) - at(1)), Eigen::Vector3f(0, 1, 0));
  }
}

TEST(ElevationGrid, TurnedOverKeepsItsCorners) {
  ElevationGridGeometry g = grid(2, 2, {0, 0, 0, 0});
  const Polygons up = polygons_of(build_mesh(g));
  g.ccw = false;
  EXPECT_FALSE(build_mesh(g).ccw);
  EXPECT_EQ(polygons_of(build_mesh(g)), up);
}

struct Case {
  const char* name;
  std::int32_t x, z;
  std::size_t polygons;
};
class ElevationGridSize : public testing::TestWithParam<Case> {};
// 6.17: "If either the xDimension or the zDimension is less than two, the ElevationGrid contains no quadrilaterals."
TEST_P(ElevationGridSize, IsThatOfItsMesh) {
  const auto [name, x, z, polygons] = GetParam();
  const ElevationGridGeometry g = grid(x, z, std::vector<float>(static_cast<std::size_t>(x * z)));
  const Mesh mesh = build_mesh(g);
  EXPECT_EQ(mesh.polygon_count(), polygons);
  EXPECT_EQ(mesh.vertices.size(), polygons == 0 ? 0U : g.height.size());
  EXPECT_EQ(mesh_size(g), counted(mesh));
}
INSTANTIATE_TEST_SUITE_P(Table, ElevationGridSize,
                         testing::Values(Case{"Nothing", 0, 0, 0}, Case{"NoRows", 5, 0, 0}, Case{"NoColumns", 0, 5, 0},
                                         Case{"OnePoint", 1, 1, 0}, Case{"OneRow", 5, 1, 0}, Case{"OneColumn", 1, 5, 0},
                                         Case{"OneQuadrilateral", 2, 2, 1}, Case{"Many", 7, 4, 18}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(ElevationGrid, RoundsEachCoordinateOnce) {
  ElevationGridGeometry g = grid(1001, 2, std::vector<float>(2002));
  g.x_spacing = 0.1F;
  const Mesh mesh = build_mesh(g);
  for (std::size_t i = 0; i < 1001; ++i) {
    EXPECT_EQ(mesh.vertices[i].x(), static_cast<float>(static_cast<double>(0.1F) * static_cast<double>(i)));
  }
}

TEST(ElevationGrid, StaysFinite) {
  ElevationGridGeometry g = grid(3, 2, std::vector<float>(6));
  g.x_spacing = 3e38F;
  EXPECT_EQ(build_mesh(g).vertices[2].x(), std::numeric_limits<float>::max());
}

}  // namespace peerd::elevation_grid_test
