#include <gtest/gtest.h>

#include "tests/collision/contact/convex_pairs.hpp"

namespace peerd::collision::rotational_contact_test {

using namespace test;

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

}  // namespace peerd::collision::rotational_contact_test
