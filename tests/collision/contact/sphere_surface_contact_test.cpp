#include "collision/contact/sphere_surface_contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include "collision/contact/contact_time.hpp"
#include "core/scene/reader.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::sphere_surface_contact_test {

using test::moving;

// A ball of radius 0.5 m and another object, by their geometries.
struct Two {
  explicit Two(const std::string& geometry, const std::string& ball = "Sphere { radius 0.5 }") {
    const std::string text = "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry " + ball +
                             " } }\nDEF B Transform { children Shape { geometry " + geometry + " } }\n";
    scene = std::move(read_world(text).scene.value());
    a = make_body(scene, scene.find("A").value());
    b = make_body(scene, scene.find("B").value());
  }
  [[nodiscard]] Contact meet(const KinematicState& of_a, const KinematicState& of_b, double horizon_s) const {
    EXPECT_TRUE(meet_as_sphere_and_surface({a, of_a}, {b, of_b}));
    return first_contact({a, of_a}, {b, of_b}, CollisionType::kWitness, horizon_s);
  }
  [[nodiscard]] Contact meet(const KinematicState& of_a, double horizon_s) const { return meet(of_a, {}, horizon_s); }

  Scene scene;
  Body a, b;
};

const char* const kBox = "Box { size 4 2 4 }";  // its top is at y = 1 m
// Two triangles in the plane y = 1 m, of one polygon each; their common edge is the diagonal.
const char* const kSheet =
    "IndexedFaceSet { solid FALSE coord Coordinate { point [-2 1 -2, -2 1 2, 2 1 2, 2 1 -2] } "
    "coordIndex [0 1 2 -1, 0 2 3 -1] }";
// Two triangles of a roof whose ridge is the z axis.
const char* const kRoof =
    "IndexedFaceSet { solid FALSE coord Coordinate { point [0 0 -2, 0 0 2, -2 -1 0, 2 -1 0] } "
    "coordIndex [0 2 1 -1, 0 1 3 -1] }";
// A prism over an L: not convex.
const char* const kPrism =
    "IndexedFaceSet { convex FALSE coord Coordinate { point [-1 -1 -1, 1 -1 -1, 1 0 -1, 0 0 -1, 0 1 -1, -1 1 -1, "
    "-1 -1 1, 1 -1 1, 1 0 1, 0 0 1, 0 1 1, -1 1 1] } coordIndex [5 4 3 2 1 0 -1, 6 7 8 9 10 11 -1, 0 1 7 6 -1, "
    "1 2 8 7 -1, 2 3 9 8 -1, 3 4 10 9 -1, 4 5 11 10 -1, 5 0 6 11 -1] }";

TEST(SphereSurfaceContact, OfAFaceItIsExact) {
  const Two two(kBox);
  const Contact c = two.meet(moving({0.25, 3.5, 0.5}, {0, -4, 0}), 1.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_EQ(c.time_s, 0.5);
  EXPECT_EQ(c.normal_world, Vec3::UnitY());
  EXPECT_FALSE(c.resting);
  // A ball that falls from rest: 1/2 g t^2 = 2 m.
  const Contact fallen = two.meet(moving({0.25, 3.5, 0.5}, {0, 0, 0}, {0, -16, 0}), 1.0);
  ASSERT_EQ(fallen.state, ContactState::kContact);
  EXPECT_NEAR(fallen.time_s, 0.5, 1e-15);
}

TEST(SphereSurfaceContact, OfABallBetweenItsFacetsItIsTheBalls) {
  // The polygons of a Sphere are inside it: in that direction there is no corner of them.
  const Two two(kBox);
  KinematicState turned = moving({0, 3.5, 0}, {0, -4, 0});
  turned.orientation = Quat(Eigen::AngleAxisd(0.05, Vec3(1, 0, 0.4).normalized()));
  const Contact c = two.meet(turned, 1.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_EQ(c.time_s, 0.5);
}

TEST(SphereSurfaceContact, OfAnEdgeAndACornerTheNormalIsTheLineToTheCentre) {
  const Two two(kBox);
  const Contact edge = two.meet(moving({2.3, 3, 0}, {0, -1, 0}), 3.0);
  ASSERT_EQ(edge.state, ContactState::kContact);
  EXPECT_NEAR(edge.time_s, 2.0 - 0.4, 1e-14);  // 0.3, 0.4, 0.5
  EXPECT_NEAR((edge.normal_world - Vec3(0.6, 0.8, 0)).norm(), 0.0, 1e-14);
  const Contact corner = two.meet(moving({2.2, 3, 2.1}, {0, -1, 0}), 3.0);
  ASSERT_EQ(corner.state, ContactState::kContact);
  const double up = std::sqrt(0.25 - 0.04 - 0.01);
  EXPECT_NEAR(corner.time_s, 2.0 - up, 1e-14);
  EXPECT_NEAR((corner.normal_world - Vec3(0.4, 2 * up, 0.2)).norm(), 0.0, 1e-14);
}

TEST(SphereSurfaceContact, PassesByWithoutATouch) {
  const Two two(kBox);
  EXPECT_EQ(two.meet(moving({2.5 + 1e-12, 3, 0}, {0, -10, 0}), 1.0).state, ContactState::kSeparated);
  EXPECT_EQ(two.meet(moving({2.5 - 1e-12, 3, 0}, {0, -10, 0}), 1.0).state, ContactState::kContact);
}

// The rule of touching of first_contact().
TEST(SphereSurfaceContact, AtTheStartTouchingIsToldByTheMotion) {
  const Vec3 touching(0.25, 1.5, 0.5);
  for (const char* const geometry : {kBox, kSheet}) {
    SCOPED_TRACE(geometry);
    const Two two(geometry);
    const auto meet = [&](const Vec3& v, const Vec3& a) { return two.meet(moving(touching, v, a), 1.0); };
    const Contact comes = meet({0, -1, 0}, {0, 0, 0});
    EXPECT_EQ(comes.state, ContactState::kContact);
    EXPECT_EQ(comes.time_s, 0.0);
    EXPECT_FALSE(comes.resting);
    const Contact pressed = meet({0, 0, 0}, {0, -9.81, 0});
    EXPECT_EQ(pressed.state, ContactState::kContact);
    EXPECT_EQ(pressed.time_s, 0.0);
    EXPECT_TRUE(pressed.resting);
    EXPECT_EQ(pressed.normal_world, Vec3::UnitY());
    EXPECT_EQ(meet({0, 1, 0}, {0, 0, 0}).state, ContactState::kSeparated);
    EXPECT_EQ(meet({0, 0, 0}, {0, 0, 0}).state, ContactState::kSeparated);
    EXPECT_EQ(meet({1, 0, 0}, {0, 0, 0}).state, ContactState::kSeparated);  // it slides
    const Contact back = meet({0, 2, 0}, {0, -8, 0});
    ASSERT_EQ(back.state, ContactState::kContact);
    EXPECT_NEAR(back.time_s, 0.5, 1e-15);
    EXPECT_FALSE(back.resting);
    const Contact too_low = meet({0, 1e-9, 0}, {0, -9.81, 0});
    EXPECT_EQ(too_low.state, ContactState::kContact);
    EXPECT_TRUE(too_low.resting);
  }
}

TEST(SphereSurfaceContact, SlidingOverTheEdgeBetweenTwoTrianglesOfAPlaneMeetsNothing) {
  for (const char* const geometry : {kBox, kSheet}) {
    const Two two(geometry);
    for (int i = 0; i < 200; ++i) {
      const double x = -1.5 + 3.0 * i / 200, z = 0.3 * std::sin(i);
      for (const double gap : {-1e-16, 0.0, 1e-16, 1e-15, 1e-12}) {
        const Vec3 velocity(3.0 * std::cos(7 * i), 0, 3.0 * std::sin(7 * i));
        const double horizon = 0.1;  // it stays over the top
        EXPECT_EQ(two.meet(moving({x, 1.5 + gap, z}, velocity), horizon).state, ContactState::kSeparated) << geometry;
      }
    }
  }
}

TEST(SphereSurfaceContact, RollsOffAnEdgeAndFallsFreely) {
  // Its centre is at the edge, from which it comes off because it moves across; then it falls beside the box.
  const Two two(kBox);
  const Contact c = two.meet(moving({2.0 + 1e-9, 1.5, 0}, {4, 0, 0}, {0, -9.81, 0}), 0.25);
  EXPECT_EQ(c.state, ContactState::kSeparated);
  // Slow, it stays on the edge: the acceleration presses more than the way across takes off.
  const Contact slow = two.meet(moving({2.0 + 1e-9, 1.5, 0}, {0.1, 0, 0}, {0, -9.81, 0}), 0.25);
  ASSERT_EQ(slow.state, ContactState::kContact);
  EXPECT_EQ(slow.time_s, 0.0);
}

// Whichever triangle comes first: the two see one point of their edge, though they go along it in opposite directions.
TEST(SphereSurfaceContact, OfAnEdgeTheTrianglesOnBothSidesSayTheSameToTheBit) {
  const std::string points =
      "IndexedFaceSet { solid FALSE coord Coordinate { point [0.1 0.3 -2, -0.3 0.2 2.1, -2 -1.7 0, 2 -1.6 0.1] } ";
  const Two left(points + "coordIndex [0 2 1 -1] }"), right(points + "coordIndex [0 1 3 -1] }");
  for (int i = 0; i < 200; ++i) {
    const double z = -1.5 + 0.015 * i;
    const KinematicState falls = moving({-0.1 - 0.0975 * z, 3, z}, {0.01, -1.3, 0.02});
    const Contact of_left = left.meet(falls, 5.0), of_right = right.meet(falls, 5.0);
    ASSERT_EQ(of_left.state, ContactState::kContact);
    ASSERT_EQ(of_right.state, ContactState::kContact);
    EXPECT_EQ(of_left.time_s, of_right.time_s) << i;
    EXPECT_EQ(of_left.normal_world, of_right.normal_world) << i;
  }
}

// Where the object that has the ball is beside it, and turned, the ball is where that puts it.
TEST(SphereSurfaceContact, OfABallBesideItsObjectItIsTheBalls) {
  const std::string text =
      std::string("#VRML V2.0 utf8\nDEF A Transform { children Transform { translation 0.25 0.5 -0.75 ") +
      "children Shape { geometry Sphere { radius 0.5 } } } }\n";
  const Scene scene = std::move(read_world(text).scene.value());
  const Body beside = make_body(scene, scene.find("A").value());
  const Two two(kBox);
  for (const double angle : {0.0, 0.5, 2.0}) {
    KinematicState s = moving({0.25, 4.5, 0.5}, {0.1, -4, 0.2});
    s.orientation = Quat(Eigen::AngleAxisd(angle, Vec3(1, 2, -2) / 3.0));
    const KinematicState of_ball = moving(s.pose() * Vec3(0.25, 0.5, -0.75), s.velocity);
    ASSERT_TRUE(meet_as_sphere_and_surface({beside, s}, {two.b, {}}));
    const Contact c = first_contact({beside, s}, {two.b, {}}, CollisionType::kWitness, 2.0),
                  same = two.meet(of_ball, 2.0);
    ASSERT_EQ(same.state, ContactState::kContact);
    ASSERT_EQ(c.state, ContactState::kContact) << angle;
    EXPECT_NEAR(c.time_s, same.time_s, 1e-14);
    EXPECT_LT((c.normal_world - same.normal_world).norm(), 1e-14);
  }
}

// A polygon without an area has no normal of its own.
TEST(SphereSurfaceContact, OfALineTheNormalIsTheLineToTheCentre) {
  const Two two(
      "IndexedFaceSet { solid FALSE coord Coordinate { point [-1 0 0, 0 0 0, 1 0 0] } coordIndex [0 1 2 -1] }");
  const Contact c = two.meet(moving({0.25, 3, 0}, {0, -1, 0}), 3.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.time_s, 2.5, 1e-14);
  EXPECT_EQ(c.normal_world, Vec3::UnitY());
}

TEST(SphereSurfaceContact, InASolidOrAcrossAFaceItOverlaps) {
  const Two two(kBox);
  const KinematicState stands = moving({0.1, 0.3, 0.2}), still;
  const Contact inside =
      first_contact({two.a, stands}, {two.b, still}, CollisionType::kWitness, 1.0, {MeetAs::kSolids});
  EXPECT_EQ(inside.state, ContactState::kOverlapped);
  EXPECT_EQ(inside.normal_world, Vec3::UnitY());
  EXPECT_TRUE(touching({two.a, stands}, {two.b, still}, CollisionType::kWitness, {MeetAs::kSolids}));
  EXPECT_FALSE(touching({two.a, stands}, {two.b, still}, CollisionType::kWitness));
  const Contact across = two.meet(moving({0.1, 1.4, 0.2}, {0, 0, 0}), 1.0);
  EXPECT_EQ(across.state, ContactState::kOverlapped);
  EXPECT_NEAR((across.normal_world - Vec3::UnitY()).norm(), 0.0, 1e-15);
}

// A box of six polygons is a room: what begins in it meets its walls from inside.
TEST(SphereSurfaceContact, OfWhatIsInsideItIsFromInside) {
  const Contact floor = Two(kBox).meet(moving({0.1, 0.3, 0.2}, {0, -4, 0}), 1.0);
  ASSERT_EQ(floor.state, ContactState::kContact);
  EXPECT_EQ(floor.time_s, 0.2);
  EXPECT_EQ(floor.normal_world, Vec3::UnitY());
  const Contact lies = Two(kBox).meet(moving({0.1, -0.5, 0.2}, {0, 0, 0}, {0, -9.81, 0}), 1.0);
  EXPECT_EQ(lies.state, ContactState::kContact);
  EXPECT_EQ(lies.time_s, 0.0);
  EXPECT_TRUE(lies.resting);
  EXPECT_EQ(Two(kBox).meet(moving({0.1, 0, 0.2}, {0, 0, 0}), 1.0).state, ContactState::kSeparated);
}

TEST(SphereSurfaceContact, IsTheSameFromBothSides) {
  const Two two(kPrism);
  const KinematicState ball = moving({1.2, 3, 0.4}, {-0.7, -4, 0.1}), still;
  const Contact c = first_contact({two.a, ball}, {two.b, still}, CollisionType::kWitness, 1.0);
  const Contact back = first_contact({two.b, still}, {two.a, ball}, CollisionType::kWitness, 1.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  ASSERT_EQ(back.state, ContactState::kContact);
  EXPECT_EQ(c.time_s, back.time_s);
  EXPECT_EQ(c.normal_world, -back.normal_world);
  EXPECT_EQ(back.collidee_polygon, 0u);
}

TEST(SphereSurfaceContact, OfAnyMagnitudeItErrsByRounding) {
  for (const double size : {1e-6, 1e-3, 1.0, 1e3}) {
    const std::string s = std::to_string(size);
    for (const double far : {0.0, 1e3, 1e7}) {
      const Two two("Box { size " + s + ' ' + s + ' ' + s + " }", "Sphere { radius " + s + " }");
      const double r = two.a.sphere->radius_m, half = two.b.radius_m / std::sqrt(3.0);
      const Contact c =
          two.meet(moving({far, far + 4 * r + half, far}, {0, -r, 0}), moving({far, far, far}, {0, 0, 0}), 10.0);
      const double ulp = std::nextafter(far + 4 * r, 1e300) - (far + 4 * r);
      if (ulp > 1e-3 * r) continue;
      ASSERT_EQ(c.state, ContactState::kContact);
      EXPECT_NEAR(c.time_s, 3.0, 1e-6 + 200 * ulp / r) << size << ' ' << far;
      EXPECT_LE(c.time_s, 3.0 + 1e-6 + 2 * ulp / r);
    }
  }
}

// ---- against the distance itself, at many instants ----

double segment_distance(const Vec3& p, const Vec3& u, const Vec3& v) {
  const Vec3 edge = v - u;
  const double s = std::clamp((p - u).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (p - u - s * edge).norm();
}
double triangle_distance(const Vec3& p, const Triangle& t) {
  double d =
      std::min({segment_distance(p, t[0], t[1]), segment_distance(p, t[1], t[2]), segment_distance(p, t[2], t[0])});
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], q = p - t[0];
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), x = e1.dot(q), y = e2.dot(q), D = a * c - b * b;
  const double s = (c * x - b * y) / D, r = (a * y - b * x) / D;
  if (s >= 0 && r >= 0 && s + r <= 1) d = std::min(d, (q - s * e1 - r * e2).norm());
  return d;
}
double gap_at(const Two& two, const KinematicState& ball, const KinematicState& other, double t) {
  const KinematicState a = advance(ball, t), b = advance(other, t);
  const Vec3 p = b.orientation.conjugate() * Vec3(a.position - b.position);
  double d = 1e300;
  const TriangleSoup& soup = two.b.surface->soup();
  for (std::uint32_t i = 0; i < soup.faces.size(); ++i) d = std::min(d, triangle_distance(p, soup.triangle(i)));
  return d - two.a.sphere->radius_m;
}

TEST(SphereSurfaceContact, IsTheFirstInstantWithoutAGap) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&](double size) { return Vec3(size * any(random), size * any(random), size * any(random)); };
  const std::array<Two, 3> all{Two(kBox), Two(kPrism), Two(kRoof)};
  int contacts = 0, turning = 0;
  for (int i = 0; i < 1500; ++i) {
    const Two& two = all[std::size_t(i) % 3];
    KinematicState ball = moving(vector(4.0), vector(8.0), i % 2 ? vector(20.0) : Vec3::Zero());
    KinematicState other = moving(vector(0.5), vector(2.0), i % 4 ? vector(3.0) : Vec3::Zero());
    other.orientation = Quat(Eigen::AngleAxisd(3.0 * any(random), vector(1.0).normalized()));
    if (i % 3 == 0) other.angular_velocity_body = vector(12.0);
    if (i % 5 == 0) ball.angular_velocity_body = vector(30.0);
    if (gap_at(two, ball, other, 0.0) < 1e-6) continue;
    const double horizon = 0.5;
    const Contact c = two.meet(ball, other, horizon);
    if (c.state == ContactState::kOverlapped) continue;  // within the solid box
    SCOPED_TRACE(i);
    ASSERT_NE(c.state, ContactState::kFailed);
    const bool met = c.state == ContactState::kContact;
    const double until = met ? c.time_s : horizon;
    for (int k = 0; k < 1000; ++k) ASSERT_GT(gap_at(two, ball, other, until * k / 1000.0), -1e-11);
    if (!met) continue;
    ++contacts;
    turning += i % 3 == 0;
    EXPECT_NEAR(gap_at(two, ball, other, c.time_s), 0.0, 1e-11);
    EXPECT_LT(gap_at(two, ball, other, c.time_s + 1e-7), 1e-11);
    // Along the normal the gap closes.
    const KinematicState a = advance(ball, c.time_s), b = advance(other, c.time_s);
    const Vec3 spin = b.orientation * b.angular_velocity_body;
    const Vec3 place = a.position - two.a.sphere->radius_m * c.normal_world;
    EXPECT_LT(c.normal_world.dot(a.velocity - b.velocity - spin.cross(place - b.position)), 1e-6);
  }
  EXPECT_GT(contacts, 150);
  EXPECT_GT(turning, 50);
}

}  // namespace peerd::collision::sphere_surface_contact_test
