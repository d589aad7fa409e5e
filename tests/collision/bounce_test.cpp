#include <gtest/gtest.h>

#include <cmath>

#include "collision/contact/contact_time.hpp"
#include "tests/collision/shapes.hpp"

// Chains of contacts as a caller lives them: move to the contact time, reflect, ask again. Nothing may stick (a contact
// at 0 after a bounce) or skip (end on the other side).
namespace peerd::collision::bounce_test {

using namespace test;

void reflect(KinematicState& s, const Vec3& n) { s.velocity -= 2.0 * s.velocity.dot(n) * n; }

struct Case {
  const char* name;
  bool flat_walls;
  bool whole_nanoseconds;  // rounded down, as replication does
};
class BetweenWalls : public testing::TestWithParam<Case> {};
TEST_P(BetweenWalls, FirstOrderNeverSticksNorSkips) {
  const Body cube = box(0.2F, 0.2F, 0.2F);
  const Body wall = GetParam().flat_walls ? body_of(wall_mesh(1000, 1000)) : box(1, 1000, 1000);
  const double inset = GetParam().flat_walls ? 0.0 : 0.5, free = 4.0 - 0.5 * static_cast<double>(0.2F);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Quat tilt = random_rotation(rng);
    const Vec3 middle = random_vector(rng, 1000.0), x = tilt * Vec3::UnitX();
    KinematicState left = moving(middle - (4.0 + inset) * x), right = moving(middle + (4.0 + inset) * x),
                   s = moving(middle);
    left.orientation = right.orientation = s.orientation = tilt;
    s.velocity = tilt * Vec3(3.0 + 0.1 * static_cast<double>(seed), 0.2, -0.1);
    const double speed = s.velocity.dot(x);
    double t = 0.0;
    for (int i = 0; i < 60; ++i) {
      const Contact a = first_contact({cube, s}, {wall, left}, CollisionType::kWitness, 50.0);
      const Contact b = first_contact({cube, s}, {wall, right}, CollisionType::kWitness, 50.0);
      const bool to_right = s.velocity.dot(x) > 0.0;
      const Contact& c = to_right ? b : a;
      ASSERT_EQ(c.state, ContactState::kContact) << i;
      ASSERT_EQ((to_right ? a : b).state, ContactState::kSeparated) << i;
      const double expected = (i == 0 ? 1.0 : 2.0) * free / speed;
      ASSERT_NEAR(c.time_s, expected, 1e-8) << i;
      ASSERT_NEAR(c.normal_world.dot(x), to_right ? -1.0 : 1.0, 1e-12);
      const double dt = GetParam().whole_nanoseconds ? std::floor(c.time_s * 1e9) * 1e-9 : c.time_s;
      s = advance(s, dt);
      reflect(s, c.normal_world);
      t += dt;
    }
    EXPECT_NEAR(t, 119.0 * free / speed, 1e-6);
  }
}

TEST_P(BetweenWalls, SecondOrderBouncesOnAFloor) {
  const Body cube = box(0.2F, 0.2F, 0.2F);
  const Body floor = GetParam().flat_walls ? body_of(floor_mesh(1000, 1000)) : box(1000, 1, 1000);
  const double half = 0.5 * static_cast<double>(0.2F), top = GetParam().flat_walls ? 0.0 : 0.5;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Quat tilt = seed == 1 ? Quat::Identity() : random_rotation(rng);
    const Vec3 up = tilt * Vec3::UnitY();
    const Vec3 offset = random_vector(rng, 100.0);
    KinematicState ground = moving(offset),
                   s = moving(offset + (top + half + 1.0) * up, tilt * Vec3(0.3, 0, 0), -9.81 * up);
    ground.orientation = s.orientation = tilt;
    const double fall = std::sqrt(2.0 / 9.81);
    for (int i = 0; i < 100; ++i) {
      const Contact c = first_contact({cube, s}, {floor, ground}, CollisionType::kWitness, 50.0);
      ASSERT_EQ(c.state, ContactState::kContact) << i;
      ASSERT_FALSE(c.resting);
      ASSERT_NEAR(c.time_s, i == 0 ? fall : 2.0 * fall, 1e-6) << i;
      ASSERT_NEAR(c.normal_world.dot(up), 1.0, 1e-12);
      s = advance(s, GetParam().whole_nanoseconds ? std::floor(c.time_s * 1e9) * 1e-9 : c.time_s);
      reflect(s, c.normal_world);
    }
  }
}

// Each bounce keeps half the speed: the chain ends in rest, not in ever shorter bounces or a fall through the floor.
TEST_P(BetweenWalls, DampedBouncesEndInRest) {
  const Body cube = box(0.2F, 0.2F, 0.2F);
  const Body floor = GetParam().flat_walls ? body_of(floor_mesh(10, 10)) : box(10, 1, 10);
  const double start = 1.0 + 0.5 * static_cast<double>(0.2F) + (GetParam().flat_walls ? 0.0 : 0.5);
  KinematicState s = moving({0, start, 0}, Vec3::Zero(), {0, -9.81, 0});
  const KinematicState ground = moving(Vec3::Zero());
  for (int i = 0; i < 60; ++i) {
    const Contact c = first_contact({cube, s}, {floor, ground}, CollisionType::kWitness, 50.0);
    ASSERT_EQ(c.state, ContactState::kContact) << i;
    if (c.resting) {
      EXPECT_GT(i, 10);
      EXPECT_EQ(c.normal_world, Vec3::UnitY());
      return;
    }
    s = advance(s, c.time_s);
    ASSERT_LT(s.velocity.y(), 0.0);
    s.velocity.y() *= -0.5;
  }
  ADD_FAILURE() << "never came to rest";
}
INSTANTIATE_TEST_SUITE_P(Table, BetweenWalls,
                         testing::Values(Case{"Slabs", false, false}, Case{"SlabsInNanoseconds", false, true},
                                         Case{"Flat", true, false}, Case{"FlatInNanoseconds", true, true}),
                         [](const auto& which) { return std::string(which.param.name); });

TEST(Bounce, SpinningCubeBetweenWalls) {
  const Body cube = box(0.2F, 0.2F, 0.2F), wall = box(1, 100, 100);
  const KinematicState left = moving({-4.5, 0, 0}), right = moving({4.5, 0, 0});
  KinematicState s = moving(Vec3::Zero(), {3, 0, 0});
  s.angular_velocity_body = {0.5, 0.7, 0.3};
  for (int i = 0; i < 40; ++i) {
    const bool to_right = s.velocity.x() > 0.0;
    const Contact c = first_contact({cube, s}, {wall, to_right ? right : left}, CollisionType::kWitness, 10.0);
    ASSERT_EQ(c.state, ContactState::kContact) << i;
    ASSERT_EQ(first_contact({cube, s}, {wall, to_right ? left : right}, CollisionType::kWitness, 10.0).state,
              ContactState::kSeparated)
        << i;
    ASSERT_GT(c.time_s, i == 0 ? 1.2 : 2.5);
    ASSERT_LT(c.time_s, 2.7);
    s = advance(s, c.time_s);
    ASSERT_LT(std::abs(s.position.x()), 4.0 - 0.0999);
    reflect(s, c.normal_world);
  }
}

}  // namespace peerd::collision::bounce_test
