#include "collision/contact/mesh_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::mesh_contact_test {

using namespace test;

constexpr double kGravity = 9.81;

// Quadrilaterals of 1 m in the plane y = 0.
Mesh ground(std::uint32_t side) {
  std::vector<Eigen::Vector3f> v;
  Faces faces;
  const float middle = 0.5F * static_cast<float>(side);
  for (std::uint32_t z = 0; z <= side; ++z) {
    for (std::uint32_t x = 0; x <= side; ++x)
      v.emplace_back(static_cast<float>(x) - middle, 0.0F, static_cast<float>(z) - middle);
  }
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t i = z * (side + 1) + x;
      faces.push_back({i, i + side + 1, i + side + 2, i + 1});
    }
  }
  return make_mesh(v, faces);
}

// A box without its top: polygon 3 is gone.
Mesh tray() {
  Faces faces = kBoxFaces;
  faces.erase(faces.begin() + 3);
  return make_mesh(box_vertices(4, 2, 4), faces);
}

Contact contact(const Body& a, const KinematicState& of_a, const Body& b, const KinematicState& of_b, double horizon) {
  return first_contact({a, of_a}, {b, of_b}, CollisionType::kWitness, horizon);
}

// The same bodies as convex pieces and as surfaces.
TEST(MeshContact, IsThatOfConvexPiecesButForTheTolerance) {
  std::mt19937_64 rng(31);
  int contacts = 0, late = 0;
  for (int i = 0; i < 400; ++i) {
    const Body a = body_of(random_polyhedron(rng, 8)), b = body_of(random_polyhedron(rng, 12));
    KinematicState of_a = moving(random_vector(rng, 1.0) + Vec3(5, 0, 0), random_vector(rng, 1.0) - Vec3(3, 0, 0),
                                 random_vector(rng, 1.0)),
                   of_b = moving(random_vector(rng, 0.5), random_vector(rng, 1.0));
    of_a.orientation = random_rotation(rng);
    of_b.orientation = random_rotation(rng);
    if (i % 2 == 0) of_a.angular_velocity_body = random_vector(rng, 2.0);
    const Contact truth = contact(a, of_a, b, of_b, 3.0);
    const Contact c = mesh_contact({a, of_a}, {b, of_b}, 3.0);
    if (truth.state != ContactState::kContact) {
      ASSERT_EQ(c.state, truth.state) << i;
      continue;
    }
    ++contacts;
    ASSERT_EQ(c.state, ContactState::kContact) << i;
    ASSERT_LE(c.time_s, truth.time_s + 2e-6) << i;
    late += c.time_s < truth.time_s - 1e-4;  // what grazes meets within the tolerance long before it touches
    ASSERT_NEAR(c.normal_world.norm(), 1.0, 1e-12);
    ASSERT_FALSE(c.resting);
  }
  EXPECT_GT(contacts, 120);
  EXPECT_LE(late, 2);
}

TEST(MeshContact, AStickGoesThroughARingOrHitsIt) {
  const Body stick = box(0.1F, 4, 0.1F);
  std::vector<Eigen::Vector3f> v;
  Faces faces;
  const std::uint32_t around = 24;
  for (std::uint32_t i = 0; i < around; ++i) {
    const auto angle = 2.0F * 3.14159265F * static_cast<float>(i) / static_cast<float>(around);
    for (const float r : {1.0F, 1.5F}) v.emplace_back(r * std::cos(angle), 0.0F, r * std::sin(angle));
    const std::uint32_t j = (i + 1) % around;
    faces.push_back({2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
  }
  const Body ring = body_of(make_mesh(v, faces));
  ASSERT_NE(ring.not_convex_reason, "");
  const KinematicState still = moving(Vec3::Zero());
  EXPECT_EQ(contact(stick, moving({0.3, 5, 0.4}, {0, -10, 0}), ring, still, 2.0).state, ContactState::kSeparated);
  const Contact hit = contact(stick, moving({1.2, 5, 0.1}, {0, -10, 0}), ring, still, 2.0);
  ASSERT_EQ(hit.state, ContactState::kContact);
  EXPECT_LE(hit.time_s, 0.3);
  EXPECT_NEAR(hit.time_s, 0.3, 2e-7);
  EXPECT_EQ(hit.normal_world, Vec3(0, 1, 0));
  EXPECT_EQ(hit.collidee_polygon, 0U);
  const Contact from_below = contact(stick, moving({1.2, -5, 0.1}, {0, 10, 0}), ring, still, 2.0);
  EXPECT_EQ(from_below.normal_world, Vec3(0, -1, 0));
}

TEST(MeshContact, ABallBouncesOnGroundThatIsManyPolygons) {
  std::mt19937_64 rng(7);
  const Body ball = body_of(random_polyhedron(rng, 40)), floor = body_of(ground(12));
  ASSERT_NE(floor.not_convex_reason, "");
  const KinematicState still = moving(Vec3::Zero());
  KinematicState s = moving({0.2, 5, 0.3}, {0.1, 0, 0.05}, {0, -kGravity, 0});
  double lowest = 0.0;
  for (const Vec3& p : ball.vertices()) lowest = std::min(lowest, p[1]);
  const double height = 5.0 + lowest, period = 2.0 * std::sqrt(2.0 * height / kGravity);
  double t = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Contact c = contact(ball, s, floor, still, 10.0);
    ASSERT_EQ(c.state, ContactState::kContact) << i;
    ASSERT_FALSE(c.resting) << i;
    ASSERT_EQ(c.normal_world, Vec3(0, 1, 0)) << i;
    const double dt = std::floor(c.time_s * 1e9) * 1e-9;
    t += dt;
    ASSERT_NEAR(t, (i + 0.5) * period, 1e-5) << i;
    s = advance(s, dt);
    s.velocity[1] = -s.velocity[1];
  }
}

// The normal is the polygon's own, and not the direction between two near points, which rounding turns.
TEST(MeshContact, OnATiltedFloorTheNormalIsThePolygons) {
  std::mt19937_64 rng(8);
  const Body ball = body_of(random_polyhedron(rng, 40)), floor = body_of(ground(12));
  for (int i = 0; i < 20; ++i) {
    KinematicState tilted = moving(random_vector(rng, 3.0));
    tilted.orientation = random_rotation(rng);
    const Vec3 n = tilted.orientation * Vec3(0, 1, 0);
    KinematicState s = moving(tilted.pose() * Vec3(0.2, 5, 0.3), -n);
    s.orientation = random_rotation(rng);
    const Contact c = contact(ball, s, floor, tilted, 10.0);
    ASSERT_EQ(c.state, ContactState::kContact) << i;
    EXPECT_LT((c.normal_world - n).norm(), 1e-14) << i;
  }
}

TEST(MeshContact, SlidingOverSeamsMeetsNothing) {
  const Body crate = box(1, 1, 1), floor = body_of(ground(40));
  const KinematicState still = moving(Vec3::Zero());
  const double gap = 0.7 * kAdvancementTolerance_m;
  const Contact free = contact(crate, moving({-15, 0.5 + gap, -3.3}, {3, 0, 1}), floor, still, 9.0);
  EXPECT_EQ(free.state, ContactState::kSeparated);
  // Pressed, it rests; the normal is the ground's.
  const Contact pressed =
      contact(crate, moving({-15, 0.5 + gap, -3.3}, {3, 0, 1}, {0, -kGravity, 0}), floor, still, 9.0);
  EXPECT_EQ(pressed.state, ContactState::kContact);
  EXPECT_EQ(pressed.time_s, 0.0);
  EXPECT_TRUE(pressed.resting);
  EXPECT_EQ(pressed.normal_world, Vec3(0, 1, 0));
}

TEST(MeshContact, WhatStandsInATrayMeetsItsWalls) {
  const Body crate = box(1, 1, 1), around = body_of(tray());
  ASSERT_NE(around.not_convex_reason, "");
  const KinematicState still = moving(Vec3::Zero());
  const double on_bottom = -1.0 + 0.5 + 0.7 * kAdvancementTolerance_m;
  const Contact wall = contact(crate, moving({0, on_bottom, 0}, {2, 0, 0}), around, still, 2.0);
  ASSERT_EQ(wall.state, ContactState::kContact);
  EXPECT_NEAR(wall.time_s, 0.75, 1e-6);
  EXPECT_EQ(wall.normal_world, Vec3(-1, 0, 0));
  EXPECT_EQ(wall.collidee_polygon, 1U);
  EXPECT_EQ(wall.collidee_shape, ObjectId{1});
  // The crate moves into an edge between two walls and meets both; the least pair is the crate's first polygon, by its
  // edge, and +z.
  const Contact corner = contact(crate, moving({0, 0, 0}, {2, 0, 2}), around, still, 2.0);
  EXPECT_EQ(corner.normal_world, Vec3(0, 0, -1));
  EXPECT_EQ(corner.collidee_polygon, 4U);
  // At the top, outside of it, there is nothing.
  EXPECT_EQ(contact(crate, moving({0, 0, 0}, {0, 2, 0}), around, still, 9.0).state, ContactState::kSeparated);
}

// Polygon 2 of the crate is its bottom, which alone comes towards the polygon that it meets.
TEST(MeshContact, ATrayIsMetByTheBottomOfTheCrateThatFallsIntoIt) {
  const Body crate = box(1, 1, 1), around = body_of(tray());
  for (const double x : {-2.0, 2.0}) {
    for (const double z : {-2.0, 2.0}) {
      const Contact c = contact(around, moving(Vec3::Zero()), crate, moving({0, 0, 0}, {x, -1, z}), 2.0);
      ASSERT_EQ(c.state, ContactState::kContact);
      EXPECT_NEAR(c.time_s, 0.5, 1e-6);
      EXPECT_EQ(c.normal_world, Vec3(0, -1, 0));
      EXPECT_EQ(c.collidee_polygon, 2U);
    }
  }
}

TEST(MeshContact, AnOverlapFacesTheMiddleOfTheCollider) {
  const Body crate = box(1, 1, 1), floor = body_of(ground(6));
  const KinematicState still = moving(Vec3::Zero());
  for (const double y : {0.25, -0.25}) {
    const Contact c = contact(crate, moving({0.3, y, 0.3}, {0, -1, 0}), floor, still, 1.0);
    EXPECT_EQ(c.state, ContactState::kOverlapped);
    EXPECT_EQ(c.normal_world, Vec3(0, y > 0 ? 1 : -1, 0));
  }
}

// A polygon without an area faces nowhere: the normal is along the line between the middles.
TEST(MeshContact, AnOverlapWithALineFacesTheMiddleOfTheCollider) {
  const Body cube = box(1, 1, 1), line = body_of(make_mesh({{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}));
  const Contact c = mesh_contact({cube, moving({7, 0.3, 0.4})}, {line, moving({6, 0, 0.4})}, 1.0);
  ASSERT_EQ(c.state, ContactState::kOverlapped);
  EXPECT_LT((c.normal_world - Vec3(1, 0.3, 0).normalized()).norm(), 1e-12);
}

TEST(MeshContact, IsUnsupportedOnlyWhereAMeshIsBeyondAllMeasure) {
  const Body crate = box(1, 1, 1), tray_body = body_of(tray()), half_space = box(1e30F, 1, 1);
  EXPECT_TRUE(has_exact_answer(crate, half_space));
  EXPECT_TRUE(has_exact_answer(crate, tray_body));
  EXPECT_FALSE(has_exact_answer(tray_body, half_space));
  const KinematicState still = moving(Vec3::Zero());
  EXPECT_EQ(contact(tray_body, still, half_space, still, 1.0).state, ContactState::kUnsupported);
}

}  // namespace peerd::collision::mesh_contact_test
