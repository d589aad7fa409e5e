#include "peerd/view/picks/walk.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "peerd/view/picks/pick.hpp"
#include "tests/must.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::walk_test {

using peerd::testing_support::scene_of;
using view::Pickable;

// A floor at height 0; a wall whose face is at x = 5; a step of 0.5 m from z = -3 on, a block of 1 m from z = 3 on; and
// a curtain at x = -2 that nobody collides with.
constexpr const char* kHall = R"(
Transform { translation 0 -0.5 0 children Shape { geometry Box { size 40 1 20 } } }
Transform { translation 5.5 2 0 children Shape { geometry Box { size 1 4 20 } } }
Transform { translation 0 0.25 -6.5 children Shape { geometry Box { size 4 0.5 7 } } }
Transform { translation 0 0.5 6.5 children Shape { geometry Box { size 4 1 7 } } }
Collision { collide FALSE children Transform { translation -2 2 0 children Shape { geometry Box { size 0.1 4 20 } } } }
)";

class Hall {
 public:
  explicit Hall(const char* text = kHall)
      : input_(view::input_at(scene_of(text), 0.0, "w")), picker_(input_, Pickable::kColliding) {}

  Stand go(const Stride& stride) {
    return must(walk(
        [this](const Vec3& origin, const Vec3& direction) -> CastResult {
          const auto hit = must(picker_.pick(origin, direction));
          if (!hit) return std::nullopt;
          return RayHit{hit->distance_m, hit->normal};
        },
        AvatarSize{}, stride));
  }

 private:
  view::PictureInput input_;
  view::ScenePicker picker_;
};

Stride stride(const Vec3& eye, const Vec3& by) { return {eye, by, true, 0.0, 0.02}; }

TEST(Walk, GoesOverTheGround) {
  Hall hall;
  const Stand stand = hall.go(stride({0, 1.6, 0}, {-3.0, 5.0, 0.5}));
  EXPECT_TRUE(stand.eye.isApprox(Vec3(-3.0, 1.6, 0.5), 1e-12)) << stand.eye.transpose() << ": through the curtain";
  EXPECT_TRUE(stand.on_ground);
  EXPECT_EQ(stand.fall_m_s, 0.0);
}

TEST(Walk, EndsAtAWall) {
  Hall hall;
  const Stand stand = hall.go(stride({0, 1.6, 0}, {9.0, 0, 0}));
  EXPECT_NEAR(stand.eye.x(), 4.75, 1e-5);
  EXPECT_NEAR(stand.eye.z(), 0.0, 1e-12);
  EXPECT_NEAR(hall.go(stride(stand.eye, {1.0, 0, 0})).eye.x(), 4.75, 1e-5);
  EXPECT_NEAR(hall.go(stride(stand.eye, {-1.0, 0, 0})).eye.x(), 3.75, 1e-5);
}

TEST(Walk, SlidesAlongAWall) {
  Hall hall;
  const Stand stand = hall.go(stride({4.75, 1.6, 0}, {2.0, 0, 1.0}));
  EXPECT_NEAR(stand.eye.x(), 4.75, 1e-5);
  EXPECT_NEAR(stand.eye.z(), 1.0, 1e-9);
  Stride pressed = stride({4.0, 1.6, -2.0}, {0.02, 0, 0.02});
  for (int i = 0; i < 100; ++i) pressed.eye = hall.go(pressed).eye;
  EXPECT_NEAR(pressed.eye.x(), 4.75, 1e-5);
  EXPECT_NEAR(pressed.eye.z(), 0.0, 1e-9) << "nothing holds it at the wall";
}

TEST(Walk, StepsUpAndDownWhatIsLowEnough) {
  Hall hall;
  const Stand up = hall.go(stride({0, 1.6, -2.5}, {0, 0, -1.0}));
  EXPECT_TRUE(up.eye.isApprox(Vec3(0, 2.1, -3.5), 1e-12)) << up.eye.transpose();
  EXPECT_TRUE(up.on_ground);
  const Stand block = hall.go(stride({0, 1.6, 2.5}, {0, 0, 1.0}));
  EXPECT_NEAR(block.eye.z(), 2.75, 1e-5) << "1 m is too high";
  EXPECT_NEAR(block.eye.y(), 1.6, 1e-12);
}

TEST(Walk, FallsFasterAndFasterToTheGround) {
  Hall hall;
  Stride falling = stride({0, 3.6, 0}, Vec3::Zero());
  double fallen_s = 0.0;
  Stand stand;
  for (; fallen_s < 2.0 && !stand.on_ground; fallen_s += falling.for_s) {
    stand = hall.go(falling);
    falling.eye = stand.eye;
    falling.fall_m_s = stand.fall_m_s;
  }
  EXPECT_NEAR(fallen_s, std::sqrt(2.0 * 2.0 / 9.80665), 0.03) << "of a fall over 2 m";
  EXPECT_NEAR(stand.eye.y(), 1.6, 1e-12);
}

TEST(Walk, NobodyFallsWhereNothingIsBelow) {
  Hall hall;
  const Stand stand = hall.go(stride({100, 1.6, 100}, {1, 0, 0}));
  EXPECT_EQ(stand.eye, Vec3(101, 1.6, 100));
  EXPECT_FALSE(stand.on_ground);
}

TEST(Walk, WhoFliesStopsAtCeilingsAndGoesWhereItWill) {
  Hall hall;
  Stride flight{{0, 3, 0}, {0, 4, 0}, false, 0.0, 0.02};
  EXPECT_EQ(hall.go(flight).eye, Vec3(0, 7, 0));
  flight.by = {0, -9, 0};
  const Stand low = hall.go(flight);
  EXPECT_GT(low.eye.y(), 0.25);
  EXPECT_FALSE(low.on_ground);
}

TEST(Walk, SaysWhatCannotBeAsked) {
  const auto refused = [](const Vec3&, const Vec3&) -> CastResult { return std::unexpected("no"); };
  EXPECT_FALSE(walk(refused, {}, stride({0, 1.6, 0}, {1, 0, 0})));
}

}  // namespace peerd::view::walk_test
