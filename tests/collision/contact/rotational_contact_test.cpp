#include <gtest/gtest.h>

#include <numbers>

#include "tests/collision/contact/convex_pairs.hpp"

namespace peerd::collision::rotational_contact_test {

using namespace test;

KinematicState spinning(const Vec3& p, const Vec3& v, const Vec3& w) {
  KinematicState s = moving(p, v);
  s.angular_velocity_body = w;
  return s;
}

// Without rotation both ways answer alike, within the tolerance of conservative advancement.
TEST(RotationalContact, IsTheClosedFormWhereNothingTurns) {
  std::mt19937_64 rng(241);
  int contacts = 0;
  for (int i = 0; i < 100; ++i) {
    ConvexPair pair{body_of(random_polyhedron(rng, 8)), body_of(random_polyhedron(rng, 8)), {}, {}, 4.0};
    pair.of_collider = moving(Vec3(4, 0, 0) + random_vector(rng, 0.5), Vec3(-2, 0, 0) + random_vector(rng, 0.3));
    pair.of_collider.orientation = random_rotation(rng);
    const Contact closed = pair.translational(), advanced = pair.rotational();
    if (closed.state != ContactState::kContact) continue;
    ASSERT_EQ(advanced.state, ContactState::kContact) << i;
    EXPECT_LE(advanced.time_s, closed.time_s + 1e-12);
    EXPECT_GE(advanced.time_s, closed.time_s - 2e-6);
    EXPECT_GT(advanced.iterations, 0u);
    ++contacts;
  }
  EXPECT_GT(contacts, 30);
}

// A rod that turns meets a wall when its end reaches it: cos of the angle is the wall's distance over half its length.
TEST(RotationalContact, ARodMeetsAWallWithItsEnd) {
  ConvexPair pair{box(0.002F, 4, 0.002F), body_of(wall_mesh(20, 20)), {}, {}, 5.0};
  pair.of_collider = spinning({-std::sqrt(2.0), 0, 0}, {0, 0, 0}, {0, 0, -0.5});
  const Contact contact = pair.rotational();
  ASSERT_EQ(contact.state, ContactState::kContact);
  EXPECT_NEAR(contact.time_s, 0.25 * std::numbers::pi / 0.5, 0.01);
  EXPECT_GT(pair.gap_m(contact.time_s), 0.0);
  EXPECT_LT(pair.gap_m(contact.time_s), 2e-6);
}

// The answer is never late, on random spins: the largest gap is above 0 at all samples before it.
TEST(RotationalContact, IsNeverLate) {
  std::mt19937_64 rng(242);
  int contacts = 0;
  for (int i = 0; i < 150; ++i) {
    ConvexPair pair{body_of(random_polyhedron(rng, 7)), body_of(random_polyhedron(rng, 7)), {}, {}, 3.0};
    pair.of_collider = spinning(Vec3(4, 0, 0) + random_vector(rng, 0.5), Vec3(-1.5, 0, 0) + random_vector(rng, 0.5),
                                random_vector(rng, 4.0));
    pair.of_collidee = spinning(random_vector(rng, 0.2), {0, 0, 0}, random_vector(rng, 4.0));
    const Contact contact = pair.rotational();
    ASSERT_NE(contact.state, ContactState::kFailed) << i;
    const double until = contact.state == ContactState::kContact ? contact.time_s : 3.0;
    for (int k = 0; k < 200; ++k) ASSERT_GT(pair.gap_m(until * k / 200.0), 0.0) << i;
    if (contact.state != ContactState::kContact) continue;
    EXPECT_LE(pair.gap_m(contact.time_s), 1e-6);
    ++contacts;
  }
  EXPECT_GT(contacts, 50);
}

}  // namespace peerd::collision::rotational_contact_test
