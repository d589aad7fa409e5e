#include "collision/scene/scaled_geometries.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision/tree/hierarchy_file.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::collision::scaled_geometries_test {

using ::testing::HasSubstr;
using ::testing::SizeIs;

const Mat3 kWide = Vec3(2, 1, 1).asDiagonal();

TEST(ScaledGeometries, AreSharedAndForgottenWithTheirLastUser) {
  const Scene scene = scene_of("Shape { geometry Box {} }");
  SceneMeshes meshes(scene);
  ScaledGeometries geometries(scene, {});
  ScaledGeometry* const plain = *geometries.acquire(0, Mat3::Identity(), meshes);
  ScaledGeometry* const again = *geometries.acquire(0, Mat3::Identity(), meshes);
  ScaledGeometry* const wide = *geometries.acquire(0, kWide, meshes);
  EXPECT_EQ(plain, again);
  EXPECT_NE(plain, wide);
  EXPECT_NE(plain->version, wide->version);
  EXPECT_EQ(wide->soup.box.hi, Vec3(2, 1, 1));
  EXPECT_EQ(geometries.size(), 2u);
  EXPECT_EQ(geometries.counters().soups_built, 2u);
  geometries.release(*plain);
  EXPECT_EQ(geometries.size(), 2u);
  geometries.release(*plain);
  EXPECT_EQ(geometries.size(), 1u);
}

TEST(ScaledGeometries, CountNodesOfHierarchiesThatAreGone) {
  const Scene scene = scene_of("Shape { geometry Sphere {} }");
  SceneMeshes meshes(scene);
  ScaledGeometries geometries(scene, {});
  ScaledGeometry* const ball = *geometries.acquire(0, Mat3::Identity(), meshes);
  geometries.tree(ObjectId{0}, *ball).build_all();
  const std::uint64_t nodes = geometries.counters().nodes_built;
  EXPECT_GT(nodes, 10u);
  EXPECT_EQ(geometries.counters().hierarchies_built, 1u);
  geometries.release(*ball);
  EXPECT_EQ(geometries.size(), 0u);
  EXPECT_EQ(geometries.counters().nodes_built, nodes);
}

TEST(ScaledGeometries, ReshapingRefitsWhereOnlyVerticesMoved) {
  const Scene scene = scene_of(R"(
    Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] } }
    Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 5, 1 0 5, 0 1 5 ] } coordIndex [ 0 1 2 ] } }
    Shape { geometry Box {} })");
  SceneMeshes meshes(scene);
  ScaledGeometries geometries(scene, {});
  ScaledGeometry* const form = *geometries.acquire(0, Mat3::Identity(), meshes);
  (void)geometries.tree(ObjectId{0}, *form).at(WideTree::kRoot);
  const std::uint64_t before = form->version;
  int dropped = 0;
  const auto count = [&](const ScaledGeometry&) { ++dropped; };
  geometries.reshape(0, meshes.mesh(1), count);
  EXPECT_EQ(dropped, 0);
  EXPECT_EQ(geometries.counters().hierarchies_refitted, 1u);
  EXPECT_GT(form->version, before);
  EXPECT_EQ(form->soup.box.hi[2], 5.0);
  geometries.reshape(0, meshes.mesh(2), count);
  EXPECT_EQ(dropped, 1);
  EXPECT_EQ(geometries.size(), 0u);
}

TEST(ScaledGeometries, ReadHierarchiesFromTheirFilesOrSayWhyNot) {
  const Scene scene = scene_of("DEF A Shape { hierarchyFile \"a.hrc\" geometry Sphere {} }");
  SceneMeshes meshes(scene);
  std::string content;
  const HierarchyLoader load = [&](std::string_view) -> std::expected<std::optional<MappedFile>, std::string> {
    struct alignas(64) Block {
      std::byte bytes[64];
    };
    const auto blocks = std::make_shared<Block[]>(content.size() / sizeof(Block) + 1);
    std::memcpy(blocks.get(), content.data(), content.size());
    return MappedFile{blocks, {blocks[0].bytes, content.size()}};
  };
  {
    ScaledGeometries geometries(scene, load);
    ScaledGeometry* const form = *geometries.acquire(0, Mat3::Identity(), meshes);
    (void)geometries.tree(ObjectId{0}, *form);
    EXPECT_EQ(geometries.counters().hierarchies_built, 1u);
    ASSERT_THAT(geometries.notes(), SizeIs(1));
    EXPECT_THAT(geometries.notes()[0], HasSubstr("is not used: it is no hierarchy file"));
    WideTree tree(form->soup);
    content = write_hierarchy(tree);
  }
  ScaledGeometries geometries(scene, load);
  ScaledGeometry* const form = *geometries.acquire(0, Mat3::Identity(), meshes);
  (void)geometries.tree(ObjectId{0}, *form);
  EXPECT_EQ(geometries.counters().hierarchies_read, 1u);
  EXPECT_EQ(geometries.counters().hierarchies_built, 0u);
  EXPECT_THAT(geometries.notes(), SizeIs(0));
}

}  // namespace peerd::collision::scaled_geometries_test
