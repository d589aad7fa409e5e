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

TEST(TranslationalContact, TheTouchingRule) {
  EXPECT_EQ(boxes(moving({1.5, 0, 0}, {1, 0, 0})).translational().state, ContactState::kSeparated);  // parts
  EXPECT_EQ(boxes(moving({1.5, 0, 0}, {0, 1, 0})).translational().state, ContactState::kSeparated);  // slides
  const Contact approaches = boxes(moving({1.5, 0, 0}, {-1, 0, 0})).translational();
  EXPECT_EQ(approaches.state, ContactState::kContact);
  EXPECT_EQ(approaches.time_s, 0.0);
  EXPECT_FALSE(approaches.resting);
  const Contact pressed = boxes(moving({1.5, 0, 0}, {0, 0, 0}, {-1, 0, 0})).translational();
  EXPECT_EQ(pressed.state, ContactState::kContact);
  EXPECT_TRUE(pressed.resting);
  const Contact inside = boxes(moving({1.25, 0, 0}, {5, 0, 0})).translational();
  EXPECT_EQ(inside.state, ContactState::kOverlapped);
  EXPECT_EQ(inside.normal_world, Vec3(1, 0, 0));
}

// Random polyhedra: apart until the contact, touching at it, by sampling the gaps.
TEST(TranslationalContact, IsWhereTheLargestGapFirstCloses) {
  std::mt19937_64 rng(231);
  int contacts = 0;
  for (int i = 0; i < 200; ++i) {
    ConvexPair pair{body_of(random_polyhedron(rng, 8)), body_of(random_polyhedron(rng, 8)), {}, {}, 3.0};
    pair.of_collider = moving(Vec3(4, 0, 0) + random_vector(rng, 1.0), Vec3(-2, 0, 0) + random_vector(rng, 0.7),
                              random_vector(rng, 0.5));
    pair.of_collider.orientation = random_rotation(rng);
    pair.of_collidee = moving(random_vector(rng, 0.1));
    pair.of_collidee.orientation = random_rotation(rng);
    const Contact contact = pair.translational();
    const double until = contact.state == ContactState::kContact ? contact.time_s : 3.0;
    for (int k = 0; k < 100; ++k) ASSERT_GT(pair.gap_m(until * k / 100.0), -1e-12) << i;
    if (contact.state != ContactState::kContact) continue;
    ASSERT_NEAR(pair.gap_m(contact.time_s), 0.0, 1e-12);
    ASSERT_NEAR(contact.normal_world.norm(), 1.0, 1e-12);
    ++contacts;
  }
  EXPECT_GT(contacts, 50);
}

}  // namespace peerd::collision::translational_contact_test
