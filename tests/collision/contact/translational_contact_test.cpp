#include <gtest/gtest.h>

#include "tests/collision/contact/convex_pairs.hpp"

namespace peerd::collision::translational_contact_test {

using namespace test;

ConvexPair boxes(const KinematicState& collider) { return {box(1, 1, 1), box(2, 2, 2), collider, moving({0, 0, 0})}; }

TEST(TranslationalContact, BoxesMeetWhenTheirSidesDo) {
  const Contact contact = boxes(moving({5, 0.25, 0.5}, {-2, 0, 0})).translational();
  EXPECT_EQ(contact.state, ContactState::kContact);
  EXPECT_EQ(contact.time_s, 1.75);
  EXPECT_EQ(contact.normal_world, Vec3(1, 0, 0));
  EXPECT_EQ(contact.collidee_polygon, 1u);
  EXPECT_FALSE(contact.resting);
  EXPECT_EQ(contact.iterations, 0u);
}

TEST(TranslationalContact, FallsAlongAParabola) {
  // A gap of 4.5 m closes under 9 m/s^2 in one second.
  const Contact contact = boxes(moving({0, 6, 0}, {0, 0, 0}, {0, -9, 0})).translational();
  EXPECT_EQ(contact.state, ContactState::kContact);
  EXPECT_NEAR(contact.time_s, 1.0, 1e-15);
  EXPECT_EQ(contact.normal_world, Vec3(0, 1, 0));
}

}  // namespace peerd::collision::translational_contact_test
