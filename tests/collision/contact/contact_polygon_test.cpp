#include "collision/contact/contact_polygon.hpp"

#include <gtest/gtest.h>

#include "tests/collision/contact/convex_pairs.hpp"

namespace peerd::collision::contact_polygon_test {

using namespace test;

// Polygons of box(): 0 -x, 1 +x, 2 -y, 3 +y, 4 -z, 5 +z.
TEST(FaceAlong, IsTheFaceThatTheAxisIsTheNormalOf) {
  const Body body = box(1, 2, 3);
  const Solid solid = solid_of(body);
  EXPECT_EQ(face_along(solid, Mat3::Identity(), {1, 0, 0}), 1);
  EXPECT_EQ(face_along(solid, Mat3::Identity(), {0, -1, 0}), 2);
  EXPECT_EQ(face_along(solid, Mat3::Identity(), Vec3(1, 1, 0).normalized()), -1);
  const Mat3 quarter = Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5)).toRotationMatrix();  // x to y
  EXPECT_EQ(face_along(solid, quarter, {0, 1, 0}), 1);
  EXPECT_EQ(face_along({body.vertices(), nullptr, body.object}, Mat3::Identity(), {1, 0, 0}), -1);
}

TEST(FaceAlong, AFlatPolygonFacesBothWays) {
  const Body wall = body_of(wall_mesh(2, 2));
  EXPECT_EQ(face_along(solid_of(wall), Mat3::Identity(), {1, 0, 0}), 0);
  EXPECT_EQ(face_along(solid_of(wall), Mat3::Identity(), {-1, 0, 0}), 0);
}

Contact contact_of(const Body& body, const Vec3& n, const Vec3& velocity) {
  Contact contact;
  set_contact_polygon(contact, solid_of(body), Mat3::Identity(), n.normalized(), velocity, 1e-12);
  return contact;
}

TEST(SetContactPolygon, AtAnEdgeItIsTheLowestPolygonThatTheColliderRunsAgainst) {
  const Body body = box(2, 2, 2);
  // The edge between +x (1) and +y (3): coming along -y runs against 3 alone, along -x -y against both.
  EXPECT_EQ(contact_of(body, {1, 1, 0}, {0, -1, 0}).collidee_polygon, 3u);
  EXPECT_EQ(contact_of(body, {1, 1, 0}, {0, -1, 0}).normal_world, Vec3(0, 1, 0));
  EXPECT_EQ(contact_of(body, {1, 1, 0}, {-1, -1, 0}).collidee_polygon, 1u);
  // The direction runs against none of them: the lowest adjacent one is named, and the axis itself.
  const Contact away = contact_of(body, {1, 1, 0}, {1, 1, 0});
  EXPECT_EQ(away.collidee_polygon, 1u);
  EXPECT_EQ(away.normal_world, Vec3(1, 1, 0).normalized());
}

TEST(SetContactPolygon, AtAFaceItIsTheFaceWhateverTheVelocity) {
  const Contact contact = contact_of(box(2, 2, 2), {0, 0, 1}, {3, 2, 1});
  EXPECT_EQ(contact.collidee_polygon, 5u);
  EXPECT_EQ(contact.normal_world, Vec3(0, 0, 1));
  EXPECT_EQ(contact.collidee_shape, ObjectId{1});
}

}  // namespace peerd::collision::contact_polygon_test
