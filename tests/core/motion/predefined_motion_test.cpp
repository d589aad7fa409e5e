#include "core/motion/predefined_motion.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/edit/scene_editor.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::predefined_motion_test {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

// The world moves up 2 m in 2 s and down again, and turns about +y in 4 s, quarter by quarter; both for ever.
const std::string kClock = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 0 2 0, 0 0 0 ] }
DEF O OrientationInterpolator { key [ 0 0.25 0.5 0.75 1 ] keyValue [ 0 1 0 0, 0 1 0 1.57079633, 0 1 0 3.14159265, 0 1 0 4.71238898, 0 1 0 6.2831853 ] }
ROUTE T.fraction_changed TO P.set_fraction
ROUTE T.fraction_changed TO O.set_fraction
)";

TEST(PredefinedMotion, NothingMovesWhereNothingIsRouted) {
  const Scene scene = scene_of("DEF A Transform { } TimeSensor { loop TRUE }");
  PredefinedMotion motion(scene);
  EXPECT_FALSE(motion.moves(ObjectId{0}));
  EXPECT_THAT(motion.driven_transforms(), IsEmpty());
  EXPECT_EQ(motion.animation(), nullptr);
}

TEST(PredefinedMotion, ATranslationBetweenTwoKeysIsConstantVelocity) {
  const Scene scene = scene_of("DEF A Transform { rotation 0 0 1 1.5707963 children DEF LIFT Transform { } }" + kClock +
                               "ROUTE P.value_changed TO LIFT.set_translation");
  PredefinedMotion motion(scene);
  EXPECT_FALSE(motion.moves(ObjectId{0}));
  ASSERT_TRUE(motion.moves(ObjectId{1}));
  EXPECT_TRUE(motion.stays_rigid(ObjectId{1}));
  EXPECT_FALSE(motion.stays_rigid(ObjectId{0})) << "its LIFT goes up and down in it";
  EXPECT_THAT(motion.driven_transforms(), ElementsAre(ObjectId{1}));
  const auto up = motion.piece(ObjectId{1}, 0.5);
  EXPECT_EQ(up.begin_s, 0.0);
  EXPECT_EQ(up.end_s, 2.0);
  EXPECT_TRUE(up.state.velocity.isApprox(Vec3(-1, 0, 0), 1e-7)) << "its parent is turned by a quarter about z";
  EXPECT_TRUE(up.state.acceleration.isZero(0.0));
  const auto down = motion.piece(ObjectId{1}, 2.0);
  EXPECT_EQ(down.begin_s, 2.0);
  EXPECT_TRUE(down.state.velocity.isApprox(Vec3(1, 0, 0), 1e-7));
  EXPECT_TRUE(motion.rigid_pose(ObjectId{1}, 13.0).position.isApprox(Vec3(-1, 0, 0), 1e-7))
      << "13 s is 1 s into a cycle";
  EXPECT_TRUE(motion.transform(ObjectId{1}, 13.0).translation.isApprox(Vec3(0, 1, 0)));
}

// HAND stands 3 m out on ARM, which turns: its path is a circle, which no parabola is. The pieces stay within the
// promised error.
TEST(PredefinedMotion, ACircleIsCutIntoPiecesThatMeet) {
  const Scene scene = scene_of("DEF ARM Transform { children DEF HAND Transform { translation 3 0 0 } }" + kClock +
                               "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion motion(scene);
  const double jerk = 3 * std::pow(kPi / 2, 3);
  const double bound = jerk * std::pow(PredefinedMotion::kPiece_s, 3) / 125 + 1e-12;
  double t = 0.25;
  for (int i = 0; i < 2000; ++i) {
    const auto piece = motion.piece(ObjectId{1}, t);
    ASSERT_LE(piece.begin_s, t);
    ASSERT_GT(piece.end_s, t);
    ASSERT_LE(piece.end_s - piece.begin_s, PredefinedMotion::kPiece_s);
    for (const double part : {0.01, 0.2, 0.5, 0.8, 0.99}) {
      const double s = piece.begin_s + part * (piece.end_s - piece.begin_s);
      const Pose at = advance(piece.state, s - piece.begin_s).pose(), there = motion.rigid_pose(ObjectId{1}, s);
      ASSERT_LT((at.position - there.position).norm(), bound)
          << "t = " << s << ", piece from " << piece.begin_s << " to " << piece.end_s;
      ASSERT_LT(angle_between(at.orientation, there.orientation), 1e-7) << "t = " << s;
    }
    t = piece.end_s;
  }
}

TEST(PredefinedMotion, PiecesDependOnTimeAloneAndNotOnTheQuestionsBefore) {
  const Scene scene = scene_of("DEF ARM Transform { center 1 0 0 }" + kClock + "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion forwards(scene), backwards(scene);
  std::vector<PredefinedMotion::Piece> there, back;
  for (int i = 0; i < 500; ++i) there.push_back(forwards.piece(ObjectId{0}, 0.037 * i));
  for (int i = 499; i >= 0; --i) back.push_back(backwards.piece(ObjectId{0}, 0.037 * i));
  std::ranges::reverse(back);
  for (std::size_t i = 0; i < there.size(); ++i) {
    ASSERT_EQ(there[i].begin_s, back[i].begin_s);
    ASSERT_EQ(there[i].state.position, back[i].state.position);
    ASSERT_EQ(there[i].state.velocity, back[i].state.velocity);
    ASSERT_EQ(there[i].state.orientation.coeffs(), back[i].state.orientation.coeffs());
  }
}

// An arm that turns about a centre that is not its origin goes on a circle, and its pieces say which.
TEST(PredefinedMotion, ATurnAboutACentreIsACircle) {
  const Scene scene = scene_of(
      "DEF TOP Transform { scale -2 -2 -2 rotation 1 1 0 0.7 children DEF ARM Transform { translation 1 2 3 center 3 1 "
      "0 "
      "scale 1 2 3 } }" +
      kClock + "ROUTE O.value_changed TO ARM.rotation ROUTE P.value_changed TO ARM.translation");
  PredefinedMotion motion(scene);
  const ObjectId arm = *scene.find("ARM");
  for (double t = 0.1; t < 20.0; t += 0.37) {
    const auto piece = motion.piece(arm, t);
    ASSERT_FALSE(piece.turning_rad_s.isZero(0.0));
    ASSERT_LE(piece.end_s - piece.begin_s, PredefinedMotion::kCircle_s);
    const double rate = piece.turning_rad_s.norm(), s = t - piece.begin_s;
    const Vec3 a = piece.state.acceleration, j = piece.turning_rad_s.cross(a);
    const Vec3 there = piece.state.position + s * piece.state.velocity + (1 - std::cos(rate * s)) / (rate * rate) * a +
                       (s - std::sin(rate * s) / rate) / (rate * rate) * j;
    const Pose pose = motion.rigid_pose(arm, t);
    ASSERT_LT((there - pose.position).norm(), 1e-12) << t;
    ASSERT_LT(angle_between(advance(piece.state, s).orientation, pose.orientation), 1e-7) << t;
  }
}

TEST(PredefinedMotion, APieceIsInTheFrameOfWhatStandsAbove) {
  const Scene scene = scene_of(
      "DEF BUS Transform { translation 5 0 0 rotation 0 0 1 1 scale 1 3 2 children Transform { translation 0 1 0 "
      "children "
      "DEF DOOR Transform { rotation 0 1 0 0.5 } } }" +
      kClock + "ROUTE O.value_changed TO BUS.rotation ROUTE P.value_changed TO DOOR.translation");
  PredefinedMotion motion(scene);
  const ObjectId bus = *scene.find("BUS"), door = *scene.find("DOOR");
  for (double t = 0.1; t < 9.0; t += 0.37) {
    const auto piece = motion.piece(door, t, bus);
    EXPECT_TRUE(piece.state.acceleration.isZero(0.0)) << "a door that slides straight in its bus";
    const Pose in_bus = advance(piece.state, t - piece.begin_s).pose(), of_bus = motion.rigid_pose(bus, t);
    const Pose pose = motion.rigid_pose(door, t);
    ASSERT_LT((of_bus * in_bus.position - pose.position).norm(), 1e-12) << t;
    ASSERT_LT(angle_between(of_bus.orientation * in_bus.orientation, pose.orientation), 1e-7) << t;
  }
}

TEST(PredefinedMotion, AVelocityVectorMovesATranslationThatNoRouteDrives) {
  const Scene scene = scene_of(
      "DEF GOES Transform { translation 1 0 0 velocityVector 0 0 2 }"
      "DEF LIFT Transform { translation 9 9 9 velocityVector 1 1 1 }"
      "DEF SPINS Transform { velocityVector 3 0 0 }" +
      kClock + "ROUTE P.value_changed TO LIFT.translation ROUTE O.value_changed TO SPINS.rotation");
  PredefinedMotion motion(scene);
  EXPECT_THAT(motion.driven_transforms(), ElementsAre(ObjectId{0}, ObjectId{1}, ObjectId{2}));
  EXPECT_EQ(motion.transform(ObjectId{0}, 3.0).translation, Vec3(1, 0, 6));
  EXPECT_EQ(motion.transform(ObjectId{0}, -3.0).translation, Vec3(1, 0, 0)) << "before the world was read";
  EXPECT_EQ(motion.transform(ObjectId{1}, 1.0).translation, Vec3(0, 1, 0));
  const auto piece = motion.piece(ObjectId{0}, 3.0);
  EXPECT_EQ(piece.begin_s, 0.0);
  EXPECT_EQ(piece.state.velocity, Vec3(0, 0, 2));
  const auto before = motion.piece(ObjectId{0}, -3.0);
  EXPECT_EQ(before.end_s, 0.0);
  EXPECT_TRUE(before.state.velocity.isZero(0.0));
  const auto spins = motion.piece(ObjectId{2}, 3.5);
  EXPECT_EQ(spins.begin_s, 3.0);
  EXPECT_EQ(spins.state.position, Vec3(9, 0, 0));
  EXPECT_EQ(spins.state.velocity, Vec3(3, 0, 0));
  EXPECT_TRUE(spins.state.angular_velocity_body.isApprox(Vec3(0, kPi / 2, 0), 1e-6));
}

TEST(PredefinedMotion, AVectorIsInTheFrameOfTheParentAsItStands) {
  const Scene scene = scene_of("DEF ARM Transform { scale 2 2 2 children DEF HAND Transform { rotation 1 0 0 1 } }" +
                               kClock + "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion motion(scene);
  const ObjectId hand = *scene.find("ARM/HAND");
  EXPECT_EQ(motion.to_world(hand, Vec3(1, 2, 3), -1), scene.to_world(hand, Vec3(1, 2, 3)));
  for (const double t : {0.5, 1.3, 2.7}) {
    const Quat turned = motion.rigid_pose(*scene.find("ARM"), t).orientation;
    EXPECT_NEAR((motion.to_world(hand, Vec3(1, 2, 3), t) - 2 * (turned * Vec3(1, 2, 3))).norm(), 0, 1e-12) << t;
  }
}

TEST(PredefinedMotion, SaysWhatIsNoRigidBody) {
  const std::string scaled = R"(DEF S ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
    DEF UNEVEN Transform { scale 1 2 1 children DEF TURNS Transform { } }
    DEF EVEN Transform { scale 2 2 2 children DEF TURNS2 Transform { } }
    DEF GROWS Transform { })" +
                             kClock + R"(
    ROUTE O.value_changed TO TURNS.rotation ROUTE O.value_changed TO TURNS2.rotation ROUTE P.value_changed TO GROWS.scale)";
  const Scene scene = scene_of(scaled);
  const PredefinedMotion motion(scene);
  const auto id = [&](const char* path) { return scene.find(path).value(); };
  EXPECT_FALSE(motion.stays_rigid(id("TURNS")));
  EXPECT_TRUE(motion.stays_rigid(id("TURNS2")));
  EXPECT_FALSE(motion.stays_rigid(id("GROWS")));
}

TEST(PredefinedMotion, RunsThroughProtosAndTheirInterfaces) {
  const Scene scene = scene_of(R"(
    PROTO Mover [ field SFVec3f to 0 2 0  field SFTime period 4  eventOut SFVec3f moved ] {
      DEF M Transform { children DEF BOX Shape { geometry Box { } } }
      DEF T TimeSensor { cycleInterval IS period loop TRUE }
      DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 4 4 4 ] value_changed IS moved }
      ROUTE T.fraction_changed TO P.set_fraction
      ROUTE P.value_changed TO M.set_translation
    }
    DEF A Mover { period 2 } DEF B Mover { } DEF FOLLOWS Transform { }
    ROUTE A.moved TO FOLLOWS.translation)");
  PredefinedMotion motion(scene);
  EXPECT_TRUE(motion.rigid_pose(scene.find("A").value(), 1.0).position.isApprox(Vec3(2, 2, 2), 1e-7));
  EXPECT_TRUE(motion.rigid_pose(scene.find("B").value(), 1.0).position.isApprox(Vec3(1, 1, 1), 1e-7));
  EXPECT_TRUE(motion.rigid_pose(scene.find("FOLLOWS").value(), 1.0).position.isApprox(Vec3(2, 2, 2), 1e-7));
}

// Indices of an edited scene are not the numbers of its ids.
TEST(PredefinedMotion, WhatMovesInAnEditedSceneMovesAsInItsText) {
  const std::string moved = "DEF LIFT Transform { }" + kClock + "ROUTE P.value_changed TO LIFT.set_translation";
  const Scene whole = scene_of("DEF GONE Transform { translation 9 9 9 } " + moved), text = scene_of(moved);
  SceneEditor editor(whole);
  ASSERT_TRUE(editor.remove(whole.find("GONE").value()));
  const auto edited = editor.finish();
  ASSERT_TRUE(edited) << edited.error();
  PredefinedMotion motion(*edited), expected(text);
  const ObjectId lift = edited->find("LIFT").value();
  EXPECT_EQ(lift, ObjectId{1});
  const auto piece = motion.piece(lift, 0.5), as_text = expected.piece(ObjectId{0}, 0.5);
  EXPECT_EQ(piece.state.position, as_text.state.position);
  EXPECT_EQ(piece.state.velocity, as_text.state.velocity);
  EXPECT_EQ(piece.end_s, as_text.end_s);
}

}  // namespace peerd::predefined_motion_test
