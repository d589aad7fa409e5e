#include "peerd/lab/live/crossing.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/collision/shapes.hpp"

namespace peerd::crossing_test {

using collision::Body, collision::ExactSphere, collision::test::moving;

Body ball_of(double radius_m) {
  Body body = collision::test::box(1, 1, 1);
  body.sphere = ExactSphere{ObjectId{0}, Vec3::Zero(), radius_m};
  return body;
}

TEST(Crossing, OfTwoBoxesIsTheLeastOverlap) {
  const Body a = collision::test::box(1, 1, 1), b = collision::test::box(1, 1, 1);
  const KinematicState at = moving({0, 0, 0}), beside = moving({0.9, 0.2, 0}), apart = moving({1.1, 0, 0});
  for (const CollisionType type : {CollisionType::kWitness, CollisionType::kBox}) {
    EXPECT_NEAR(crossing({a, at}, {b, beside}, type).depth_m, 0.1, 1e-12);
    EXPECT_NEAR(crossing({b, beside}, {a, at}, type).depth_m, 0.1, 1e-12);
    EXPECT_EQ(crossing({a, at}, {b, apart}, type).depth_m, 0.0);
    EXPECT_FALSE(crossing({a, at}, {b, beside}, type).is_lower_bound);
  }
}

// A room is a box whose inside is free. What sticks out of it overlaps by as much as that.
TEST(Crossing, OfWhatIsInsideIsHowFarItSticksOut) {
  const Body room = collision::test::box(10, 10, 10), thing = collision::test::box(1, 1, 1), ball = ball_of(0.5);
  const KinematicState middle = moving({0, 0, 0}), inside = moving({3, 0, 0}), out = moving({4.6, 0, 0});
  for (const Body* const body : {&thing, &ball}) {
    EXPECT_EQ(crossing({*body, inside}, {room, middle}, CollisionType::kWitness).depth_m, 0.0);
    EXPECT_NEAR(crossing({*body, out}, {room, middle}, CollisionType::kWitness).depth_m, 0.1, 1e-12);
  }
}

TEST(Crossing, OfASphereIsRound) {
  const Body ball = ball_of(0.5), other = ball_of(0.25), cube = collision::test::box(1, 1, 1);
  const KinematicState middle = moving({0, 0, 0});
  EXPECT_NEAR(crossing({ball, middle}, {other, moving({0.7, 0, 0})}, CollisionType::kWitness).depth_m, 0.05, 1e-12);
  EXPECT_EQ(crossing({ball, middle}, {other, moving({0.2, 0, 0})}, CollisionType::kWitness).depth_m, 0.0) << "inside";
  EXPECT_NEAR(crossing({ball, moving({0, 0.9, 0})}, {cube, middle}, CollisionType::kWitness).depth_m, 0.1, 1e-12);
  const double diagonal = 0.5 + 0.45 / std::numbers::sqrt2;  // off an edge
  EXPECT_NEAR(crossing({ball, moving({diagonal, diagonal, 0})}, {cube, middle}, CollisionType::kWitness).depth_m, 0.05,
              1e-12);
}

}  // namespace peerd::crossing_test
