#include "collision/contact/sphere_contact.hpp"

#include <gtest/gtest.h>

#include <random>

#include "collision/contact/contact_time.hpp"
#include "core/scene/reader.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::sphere_contact_test {

using test::moving;

struct Balls {
  explicit Balls(const std::string& a = "Shape { geometry Sphere { radius 0.5 } }",
                 const std::string& b = "Shape { geometry Sphere { radius 0.25 } }") {
    const std::string text =
        "#VRML V2.0 utf8\nDEF A Transform { children " + a + " }\nDEF B Transform { children " + b + " }\n";
    scene = read_world(text).scene.value();
    bodies = {make_body(scene, scene.find("A").value()), make_body(scene, scene.find("B").value())};
  }
  [[nodiscard]] Contact meet(const KinematicState& a, const KinematicState& b, double horizon_s) const {
    return first_contact({bodies[0], a}, {bodies[1], b}, CollisionType::kWitness, horizon_s);
  }
  Scene scene;
  std::vector<Body> bodies;
};

TEST(SphereContact, IsOfTheSpheresAndNotOfTheirFacets) {
  const Balls balls;
  ASSERT_TRUE(balls.bodies[0].sphere.has_value());
  // Head-on along a direction in which the polygons are flat between two stacks and two slices.
  const Vec3 n = Vec3(0.3, 0.7, 0.2).normalized();
  const Contact c = balls.meet(moving(2.0 * n, -1.0 * n), moving({0, 0, 0}), 10.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.time_s, 1.25, 1e-13);
  EXPECT_LT((c.normal_world - n).norm(), 1e-13);
  EXPECT_FALSE(c.resting);
}

TEST(SphereContact, APlanePartsItFromASphereAndFromABox) {
  const Balls balls, with_box("Shape { geometry Sphere { radius 0.5 } }", "Shape { geometry Box { size 2 2 2 } }");
  const Vec3 n = Vec3(0.3, 0.7, 0.2).normalized();
  const auto plane = widest_parting({balls.bodies[0], moving(2.0 * n)}, {balls.bodies[1], moving({0, 0, 0})});
  ASSERT_TRUE(plane);
  EXPECT_LT((plane->normal_world - n).norm(), 1e-15);
  EXPECT_NEAR(plane->gap_m, 1.25, 1e-15);
  EXPECT_FALSE(widest_parting({balls.bodies[0], moving({0.7, 0, 0})}, {balls.bodies[1], moving({0, 0, 0})}));
  const auto face = widest_parting({with_box.bodies[0], moving({0, -4, 0})}, {with_box.bodies[1], moving({0, 0, 0})});
  ASSERT_TRUE(face);
  EXPECT_EQ(face->normal_world, -Vec3::UnitY());
  EXPECT_EQ(face->gap_m, 2.5);
  const auto back = widest_parting({with_box.bodies[1], moving({0, 0, 0})}, {with_box.bodies[0], moving({0, -4, 0})});
  ASSERT_TRUE(back);
  EXPECT_EQ(back->normal_world, Vec3::UnitY());
}

TEST(SphereContact, IsLeftToPolygonsWhereItIsNoSphere) {
  EXPECT_FALSE(Balls("Shape { geometry Box { } }").bodies[0].sphere.has_value());
  EXPECT_FALSE(Balls("[ Shape { geometry Sphere { } } Shape { geometry Sphere { } } ]").bodies[0].sphere.has_value());
  EXPECT_FALSE(Balls("Transform { scale 1 2 1 children Shape { geometry Sphere { } } }").bodies[0].sphere.has_value());
  const Balls scaled("Transform { translation 1 0 0 scale 2 2 2 children Shape { geometry Sphere { } } }");
  ASSERT_TRUE(scaled.bodies[0].sphere.has_value());
  EXPECT_EQ(scaled.bodies[0].sphere->radius_m, 2.0);
  EXPECT_EQ(scaled.bodies[0].sphere->center, Vec3(1, 0, 0));
  KinematicState turning = moving({0, 0, 0});
  turning.angular_velocity_body = {0, 0, 1};
  const KinematicState stands = moving({9, 0, 0});
  EXPECT_FALSE(meet_as_spheres({scaled.bodies[0], turning}, {scaled.bodies[1], stands})) << "its centre goes around";
  EXPECT_TRUE(meet_as_spheres({scaled.bodies[1], turning}, {scaled.bodies[0], stands}));
}

// Vectors with each component in [-size, size].
class RandomVectors {
 public:
  explicit RandomVectors(std::uint64_t seed) : rng_(seed) {}
  Vec3 operator()(double size) {
    const double x = number(), y = number();
    return {size * x, size * y, size * number()};
  }

 private:
  double number() { return 2.0 * static_cast<double>(rng_() >> 11) * 0x1p-53 - 1.0; }
  std::mt19937_64 rng_;
};

struct Start {
  const char* name;
  KinematicState a;  // B stands at the origin; they touch at 0.75 m
  ContactState state;
  double time_s;
  bool resting;
};
class Touching : public testing::TestWithParam<Start> {};
TEST_P(Touching, AtZero) {
  const Contact c = Balls().meet(GetParam().a, moving({0, 0, 0}), 10.0);
  EXPECT_EQ(c.state, GetParam().state);
  EXPECT_NEAR(c.time_s, GetParam().time_s, 1e-10);
  EXPECT_EQ(c.resting, GetParam().resting);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Touching,
    testing::Values(
        Start{"Approaching", moving({0.75, 0, 0}, {-1, 0, 0}), ContactState::kContact, 0, false},
        Start{"Parting", moving({0.75, 0, 0}, {1, 0, 0}), ContactState::kSeparated, 0, false},
        Start{"PartingAndBack", moving({0.75, 0, 0}, {1, 0, 0}, {-2, 0, 0}), ContactState::kContact, 1, false},
        Start{"Pressed", moving({0.75, 0, 0}, {0, 0, 0}, {-2, 0, 0}), ContactState::kContact, 0, true},
        Start{"BarelyLifted", moving({0.75, 0, 0}, {1e-9, 0, 0}, {-9.81, 0, 0}), ContactState::kContact, 0, true},
        Start{"StandingSoIsNoContact", moving({0.75, 0, 0}), ContactState::kSeparated, 0, false},
        Start{"PassingAcrossParts", moving({0.75, 0, 0}, {0, 3, 0}), ContactState::kSeparated, 0, false},
        Start{"PressedLessThanItPasses", moving({0.75, 0, 0}, {0, 3, 0}, {-11, 0, 0}), ContactState::kSeparated, 0,
              false},
        Start{"PressedMoreThanItPasses", moving({0.75, 0, 0}, {0, 3, 0}, {-13, 0, 0}), ContactState::kContact, 0, true},
        Start{"Overlapped", moving({0.74, 0, 0}, {-1, 0, 0}), ContactState::kOverlapped, 0, false},
        Start{"OneInsideTheOther", moving({0.125, 0, 0}, {-1, 0, 0}), ContactState::kContact, 0.375, false},
        Start{"TouchingFromInside", moving({0.25, 0, 0}, {1, 0, 0}), ContactState::kContact, 0, false},
        Start{"RestingInside", moving({0, 0.25, 0}, {0, 0, 0}, {0, 9.81, 0}), ContactState::kContact, 0, true},
        Start{"PartingInside", moving({0.25, 0, 0}, {-1, 0, 0}), ContactState::kContact, 0.5, false},
        Start{"AcrossFromInside", moving({0.26, 0, 0}, {1, 0, 0}), ContactState::kOverlapped, 0, false},
        Start{"PassesBy", moving({-5, 0.7501, 0}, {1, 0, 0}), ContactState::kSeparated, 0, false},
        Start{"JustHits", moving({-5, 0.75 - 1e-9, 0}, {1, 0, 0}), ContactState::kContact, 5 - std::sqrt(1.5e-9),
              false}),
    [](const auto& c) { return std::string(c.param.name); });

// The answer is checked against the distance itself, in small steps: no contact before it, and contact then.
TEST(SphereContact, IsTheFirstTimeAtWhichTheyTouch) {
  const Balls balls;
  RandomVectors vector(4);
  int hits = 0;
  for (int i = 0; i < 10000; ++i) {
    const KinematicState a = moving(vector(2), vector(4), vector(6)), b = moving(vector(2), vector(4), vector(6));
    const auto gap = [&](double t) { return (advance(a, t).position - advance(b, t).position).norm() - 0.75; };
    if (gap(0.0) <= 0.0) continue;
    const Contact c = balls.meet(a, b, 1.0);
    const double until = c.state == ContactState::kContact ? c.time_s : 1.0;
    for (int k = 0; k < 400; ++k) ASSERT_GT(gap(until * k / 400.0), -1e-12) << i;
    if (c.state != ContactState::kContact) continue;
    ++hits;
    EXPECT_NEAR(gap(c.time_s), 0.0, 1e-12) << i;
    const Vec3 n = (advance(a, c.time_s).position - advance(b, c.time_s).position).normalized();
    EXPECT_LT((c.normal_world - n).norm(), 1e-12);
    EXPECT_LE(n.dot(advance(a, c.time_s).velocity - advance(b, c.time_s).velocity), 1e-6);
    const Contact swapped = first_contact({balls.bodies[1], b}, {balls.bodies[0], a}, CollisionType::kWitness, 1.0);
    EXPECT_EQ(swapped.time_s, c.time_s);
    EXPECT_EQ(swapped.normal_world, Vec3(-c.normal_world));
  }
  EXPECT_GT(hits, 300);
}

TEST(SphereContact, FromInsideIsTheFirstTimeAtWhichTheyTouch) {
  const Balls balls;
  RandomVectors vector(5);
  for (int i = 0; i < 2000; ++i) {
    const KinematicState a = moving(vector(0.13), vector(4), vector(6)), b = moving(vector(0.01), vector(4), vector(6));
    const auto gap = [&](double t) { return 0.25 - (advance(a, t).position - advance(b, t).position).norm(); };
    ASSERT_GT(gap(0.0), 0.0);
    const Contact c = balls.meet(a, b, 1.0);
    const double until = c.state == ContactState::kContact ? c.time_s : 1.0;
    for (int k = 0; k < 100; ++k) ASSERT_GT(gap(until * k / 100.0), -1e-12) << i;
    if (c.state != ContactState::kContact) continue;
    EXPECT_NEAR(gap(c.time_s), 0.0, 1e-12) << i;
    const Vec3 n = (advance(b, c.time_s).position - advance(a, c.time_s).position).normalized();
    EXPECT_LT((c.normal_world - n).norm(), 1e-12);
    const MeetAs solids = MeetAs::kSolids;
    EXPECT_EQ(first_contact({balls.bodies[0], a}, {balls.bodies[1], b}, CollisionType::kWitness, 1.0, {solids}).state,
              ContactState::kOverlapped);
  }
}

TEST(SphereContact, TouchesAtItsContactTimeAndNotBefore) {
  const Balls balls;
  const KinematicState a = moving({3, 0.2, 0}, {-1, 0, 0}), b = moving({0, 0, 0});
  const Contact c = balls.meet(a, b, 10.0);
  ASSERT_EQ(c.state, ContactState::kContact);
  const KinematicState then = advance(a, c.time_s), before = advance(a, c.time_s - 1e-4);
  EXPECT_TRUE(touching({balls.bodies[0], then}, {balls.bodies[1], b}, CollisionType::kWitness));
  EXPECT_FALSE(touching({balls.bodies[0], before}, {balls.bodies[1], b}, CollisionType::kWitness));
}

}  // namespace peerd::collision::sphere_contact_test
