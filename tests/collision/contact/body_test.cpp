#include "collision/contact/body.hpp"

#include <gtest/gtest.h>

#include "collision/exact/convexity.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::body_test {

using namespace test;

TEST(MakeBody, BoxIsOnePieceOfSixPolygons) {
  const Body body = box(5.42F, 0.8F, 0.8F);
  ASSERT_EQ(body.unsupported, "");
  ASSERT_EQ(body.pieces.size(), 1U);
  const ConvexPiece& piece = body.pieces[0];
  EXPECT_EQ(piece.shape, ObjectId{1});
  EXPECT_EQ(piece.vertices.size(), 8U);
  EXPECT_EQ(piece.faces.size(), 6U);
  EXPECT_EQ(piece.face_axes.size(), 3U);
  EXPECT_EQ(piece.edge_axes.size(), 3U);
  EXPECT_EQ(piece.face_normals[0], -Vec3::UnitX());
  EXPECT_EQ(piece.face_normals[5], Vec3::UnitZ());
  EXPECT_EQ(body.center, Vec3::Zero());
  EXPECT_NEAR(body.radius_m, 0.5 * Vec3(5.42F, 0.8F, 0.8F).norm(), 1e-15);
}

TEST(MakeBody, TriangulatedBoxHasNoSeamsAmongItsEdges) {
  Faces triangles;
  for (const auto& f : kBoxFaces) {
    triangles.push_back({f[0], f[1], f[2]});
    triangles.push_back({f[0], f[2], f[3]});
  }
  const Body body = body_of(make_mesh(box_vertices(1, 2, 3), triangles));
  ASSERT_EQ(body.unsupported, "");
  EXPECT_EQ(body.pieces[0].faces.size(), 12U);
  EXPECT_EQ(body.pieces[0].face_axes.size(), 3U);
  EXPECT_EQ(body.pieces[0].edge_axes.size(), 3U);
}

TEST(MakeBody, RepeatedVerticesAreWelded) {
  std::vector<Eigen::Vector3f> v;
  Faces faces;
  for (const auto& f : kBoxFaces) {
    faces.emplace_back();
    for (const std::uint32_t i : f) {
      faces.back().push_back(static_cast<std::uint32_t>(v.size()));
      v.push_back(box_vertices(1, 1, 1)[i]);
    }
  }
  const Body body = body_of(make_mesh(v, faces));
  ASSERT_EQ(body.unsupported, "");
  EXPECT_EQ(body.pieces[0].vertices.size(), 8U);
}

// A solid's normals point out, whatever the winding says.
TEST(MakeBody, NormalsPointOutForEveryWindingAndMirroring) {
  for (const bool ccw : {true, false}) {
    for (const double mirror : {1.0, -1.0}) {
      TransformFields t;
      t.scale = {2.0 * mirror, 1.0, 0.5};
      Mesh mesh = box_mesh(1, 1, 1);
      mesh.ccw = ccw;
      const Body body = make_body(scene_of({mesh}, t), ObjectId{0});
      ASSERT_EQ(body.unsupported, "");
      const ConvexPiece& piece = body.pieces[0];
      EXPECT_NEAR(body.radius_m, 0.5 * Vec3(2, 1, 0.5).norm(), 1e-15);
      for (std::size_t i = 0; i < piece.faces.size(); ++i) {
        const auto& f = piece.faces[i];
        const Vec3 a = piece.vertices[f[0]], b = piece.vertices[f[1]], c = piece.vertices[f[2]];
        EXPECT_GT((b - a).cross(c - a).dot(piece.face_normals[i]), 0.0);
        EXPECT_GT(a.dot(piece.face_normals[i]), 0.0);
      }
    }
  }
}

TEST(MakeBody, ShearMapsNormalsAsPlanes) {
  TransformFields t;
  t.scale = {3, 1, 1};
  t.scale_orientation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitZ()));
  const Body body = make_body(scene_of({box_mesh(1, 1, 1)}, t), ObjectId{0});
  ASSERT_EQ(body.unsupported, "");
  const ConvexPiece& piece = body.pieces[0];
  for (std::size_t i = 0; i < piece.faces.size(); ++i) {
    const Vec3& n = piece.face_normals[i];
    double top = -1e9;
    for (const Vec3& v : piece.vertices) top = std::max(top, n.dot(v));
    for (const std::uint32_t v : piece.faces[i]) EXPECT_NEAR(n.dot(piece.vertices[v]), top, 1e-15);
  }
}

TEST(MakeBody, WhatIsNotConvexIsASurfaceAndSaysWhy) {
  Faces open = kBoxFaces;
  open.pop_back();
  const Mesh without_lid = make_mesh(box_vertices(1, 1, 1), open);
  const Body body = make_body(scene_of({box_mesh(1, 1, 1), without_lid}), ObjectId{0});
  EXPECT_EQ(body.unsupported, "");
  EXPECT_EQ(body.not_convex_reason, "OBJECT/1: open surface");
  EXPECT_EQ(body.pieces.size(), 1U);
  const ShapePolygon first = body.surface->polygon(5), second = body.surface->polygon(6);
  EXPECT_EQ(first.shape, ObjectId{1});
  EXPECT_EQ(first.polygon, 5U);
  EXPECT_EQ(second.shape, ObjectId{2});
  EXPECT_EQ(second.polygon, 0U);
}

TEST(MakeBody, LeavesOutWhatTheWorldTakesOut) {
  Scene scene = scene_of({box_mesh(1, 1, 1), box_mesh(2, 2, 2)});
  scene.instances[1].collides = false;
  EXPECT_EQ(make_body(scene, ObjectId{0}).pieces.size(), 1U);
  scene.geometries[1] = NoSurface{"PointSet"};
  EXPECT_TRUE(make_body(scene, ObjectId{0}).pieces.empty());
  EXPECT_EQ(make_body(scene, ObjectId{0}).unsupported, "");
}

TEST(MakeBody, NothingBelowIsNothing) {
  const Body body = make_body(scene_of({}), ObjectId{0});
  EXPECT_EQ(body.unsupported, "");
  EXPECT_TRUE(body.pieces.empty());
  EXPECT_EQ(body.radius_m, 0.0);
}

}  // namespace peerd::collision::body_test
