#include "collision/contact/body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision/exact/convexity.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::body_test {

using namespace test;
using testing::HasSubstr;

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

TEST(MakeBody, FlatPolygonFacesAsItIsWound) {
  EXPECT_EQ(body_of(wall_mesh(1, 1)).pieces.at(0).face_normals[0], Vec3::UnitX());
  Mesh clockwise = wall_mesh(1, 1);
  clockwise.ccw = false;
  EXPECT_EQ(body_of(clockwise).pieces.at(0).face_normals[0], -Vec3::UnitX());
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

struct Refused {
  const char* name;
  Mesh mesh;
  const char* why;
};
class NotConvex : public testing::TestWithParam<Refused> {};
TEST_P(NotConvex, IsASurfaceAndSaysWhy) {
  const Body body = make_body(scene_of({box_mesh(1, 1, 1), GetParam().mesh}), ObjectId{0});
  EXPECT_EQ(body.unsupported, "");
  EXPECT_THAT(body.not_convex_reason, HasSubstr("OBJECT/1: "));
  EXPECT_THAT(body.not_convex_reason, HasSubstr(GetParam().why));
  EXPECT_EQ(body.pieces.size(), 1U);
  const ShapePolygon first = body.surface->polygon(5), second = body.surface->polygon(6);
  EXPECT_EQ(first.shape, ObjectId{1});
  EXPECT_EQ(first.polygon, 5U);
  EXPECT_EQ(second.shape, ObjectId{2});
  EXPECT_EQ(second.polygon, 0U);
}

Mesh dented() {  // a box with one corner pushed in by the least binary32 step there is
  auto v = box_vertices(1, 1, 1);
  Faces triangles;
  for (const auto& f : kBoxFaces) {
    triangles.push_back({f[0], f[1], f[2]});
    triangles.push_back({f[0], f[2], f[3]});
  }
  v[4].z() = std::nextafter(v[4].z(), 0.0F);
  return make_mesh(v, triangles);
}
Mesh without_lid() {
  Faces faces = kBoxFaces;
  faces.pop_back();
  return make_mesh(box_vertices(1, 1, 1), faces);
}
Mesh two_boxes() {
  auto v = box_vertices(1, 1, 1);
  Faces faces = kBoxFaces;
  for (int i = 0; i < 8; ++i) v.push_back(v[static_cast<std::size_t>(i)] + Eigen::Vector3f(3, 0, 0));
  for (const auto& f : kBoxFaces) faces.push_back({f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8});
  return make_mesh(v, faces);
}
Mesh bent() {  // a quad out of its plane by one ulp
  return make_mesh({{0, -1, -1}, {0, 1, -1}, {std::numeric_limits<float>::denorm_min(), 1, 1}, {0, -1, 1}},
                   {{0, 1, 2, 3}});
}
Mesh huge() {
  Faces fan;
  std::vector<Eigen::Vector3f> v{{0, 0, 0}};
  for (std::uint32_t i = 0; i < 300; ++i) {
    v.emplace_back(std::cos(0.02F * static_cast<float>(i)), std::sin(0.02F * static_cast<float>(i)), 1.0F);
    if (i > 0) fan.push_back({0, i, i + 1});
  }
  return make_mesh(v, fan);
}
INSTANTIATE_TEST_SUITE_P(
    Table, NotConvex,
    testing::Values(Refused{"Dented", dented(), "concave"}, Refused{"NoLid", without_lid(), "open surface"},
                    Refused{"TwoBoxes", two_boxes(), "several parts"},
                    Refused{"Bent", bent(), "polygon 0 is not planar"},
                    Refused{"Arrow", make_mesh({{0, 0, 0}, {2, 0, 0}, {0.5F, 0.5F, 0}, {0, 2, 0}}, {{0, 1, 2, 3}}),
                            "polygon 0 is concave"},
                    Refused{"Line", make_mesh({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}), "polygon 0 has no area"},
                    Refused{"Repeats", make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 1}}),
                            "repeats a corner"},
                    Refused{"Card", make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}),
                            "several polygons in one plane"},
                    Refused{"Huge", huge(), "more than 256 polygons"}),
    [](const auto& which) { return std::string(which.param.name); });

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

TEST(Convexity, RandomHullsAreConvex) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    Mesh mesh = random_polyhedron(rng, 4 + seed);
    const auto surface = convex_surface(mesh);
    ASSERT_TRUE(surface.has_value()) << surface.error();
    EXPECT_EQ(surface->polygons.size(), 2 * mesh.vertices.size() - 4);
  }
}

TEST(Convexity, TwoHundredFacesAtOnce) {
  std::mt19937_64 rng(7);
  const Mesh mesh = random_polyhedron(rng, 102);
  ASSERT_EQ(mesh.polygon_count(), 200U);
  EXPECT_TRUE(convex_surface(mesh).has_value());
}

// Coordinates 2^100 apart: the filter can't tell, the integers can.
TEST(Convexity, WideRangeOfMagnitudes) {
  const float tiny = 0x1p-60F, large = 0x1p60F;
  const Faces faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_TRUE(convex_surface(make_mesh({{0, 0, 0}, {large, 0, 0}, {0, large, 0}, {0, 0, tiny}}, faces)).has_value());
}

}  // namespace peerd::collision::body_test
