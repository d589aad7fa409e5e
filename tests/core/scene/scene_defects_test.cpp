#include "core/scene/scene_defects.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::scene_defects_test {

TEST(SceneDefects, AreOfGeometriesNotOfTheirUses) {
  const Scene scene = scene_of(R"(
    DEF FINE Shape { geometry Box {} }
    DEF A Transform { children DEF BAD Shape { geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] }
      coordIndex [ 0 1 2 -1 0 1 -1 2 1 0 -1 ] } } }
    DEF B Transform { children USE BAD }
    DEF LINES Shape { geometry PointSet { coord Coordinate { point [ 0 0 0 ] } } }
    DEF C Shape { geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0, 0 0 1 ] } coordIndex [ 0 1 2 3 -1 0 3 1 2 -1 0 0 0 -1 ] } })");
  const SceneDefects found = defects_of(scene);
  EXPECT_EQ(found[Defect::kDegenerate].polygons, 2U);
  EXPECT_EQ(scene.path_of(found[Defect::kDegenerate].shape.value()), "A/BAD");
  EXPECT_EQ(found[Defect::kDegenerate].polygon, 1U);
  EXPECT_EQ(found[Defect::kDuplicate].polygons, 1U);
  EXPECT_EQ(found[Defect::kDuplicate].polygon, 2U);
  EXPECT_EQ(found[Defect::kNonPlanar].polygons, 2U);
  EXPECT_EQ(scene.path_of(found[Defect::kNonPlanar].shape.value()), "C");
  EXPECT_EQ(found[Defect::kNonPlanar].polygon, 0U);
  EXPECT_EQ(found[Defect::kWarped].polygons, 2U);
  EXPECT_EQ(found[Defect::kNonManifold].polygons,
            3U);  // defect of BAD: the segment runs along an edge of both triangles
  EXPECT_EQ(scene.path_of(found[Defect::kNonManifold].shape.value()), "A/BAD");
}

TEST(SceneDefects, OfEqualPrimitivesAreEqual) {
  Scene scene;
  const SphereGeometry sphere{.radius = 0.7F};
  scene.geometries = {sphere, SphereGeometry{.radius = 0.3F}, BoxGeometry{}, ConeGeometry{.side = false}};
  const SceneDefects once = defects_of(scene);
  scene.geometries.insert(scene.geometries.end(), scene.geometries.begin(), scene.geometries.begin() + 4);
  const SceneDefects twice = defects_of(scene);
  EXPECT_GT(once[Defect::kNonPlanar].polygons, 0U);
  EXPECT_FALSE(once[Defect::kNonPlanar].shape);  // nothing shows it
  EXPECT_EQ(once.boundary_edges, 24U);
  EXPECT_EQ(twice.boundary_edges, 48U);
  for (std::size_t i = 0; i < kDefects; ++i) EXPECT_EQ(2 * once.counts[i].polygons, twice.counts[i].polygons);
}

}  // namespace peerd::scene_defects_test
