#include "core/geometry/mesh.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace peerd::mesh_test {

using testing::ElementsAre;

struct Case {
  const char* name;
  std::vector<std::int32_t> corners;
  std::vector<std::vector<std::int32_t>> polygons;
};
class MakeMesh : public testing::TestWithParam<Case> {};
TEST_P(MakeMesh, FindsThePolygons) {
  const Case& c = GetParam();
  const Mesh mesh = make_mesh({}, std::vector(c.corners));
  ASSERT_EQ(mesh.polygon_count(), c.polygons.size());
  for (std::size_t i = 0; i < c.polygons.size(); ++i) {
    EXPECT_THAT(mesh.polygon(i), testing::ElementsAreArray(c.polygons[i]));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, MakeMesh,
    testing::Values(Case{"None", {}, {}}, Case{"OnlyEnds", {-1, -1}, {}}, Case{"Closed", {0, 1, 2, -1}, {{0, 1, 2}}},
                    Case{"LastEndMissing", {0, 1, 2, -1, 3, 4}, {{0, 1, 2}, {3, 4}}},
                    Case{"DoubleEndMakesNoPolygon", {-1, 0, 1, 2, -1, -1, 5, -1}, {{0, 1, 2}, {5}}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MeshBox, IsThatOfTheVerticesInUse) {
  const std::vector<Eigen::Vector3f> vertices = {{0, 0, 0}, {1, -2, 3}, {9, 9, 9}};
  const Mesh mesh = make_mesh(std::vector(vertices), std::vector<std::int32_t>{1, 0, 1, -1});
  const LocalBox box = box_of(mesh);
  EXPECT_EQ(box.lo, Eigen::Vector3f(0, -2, 0));
  EXPECT_EQ(box.hi, Eigen::Vector3f(1, 0, 3));
  EXPECT_TRUE(box_of(Mesh{}).is_empty());
}

}  // namespace peerd::mesh_test
