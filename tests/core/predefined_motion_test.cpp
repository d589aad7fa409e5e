#include "core/predefined_motion.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/moving_scene.hpp"
#include "tests/core/read_text.hpp"

namespace peerd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

// Up 2 m in 2 s and down again; a turn about +y in 4 s; both for ever.
const std::string kClock = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 0 2 0, 0 0 0 ] }
DEF O OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 0 0, 0 1 0 3.14159265, 0 1 0 6.2831853 ] }
ROUTE T.fraction_changed TO P.set_fraction
ROUTE T.fraction_changed TO O.set_fraction
)";

TEST(PredefinedMotion, NothingMovesWhereNothingIsRouted) {
  const Scene scene = scene_of("DEF A Transform { } TimeSensor { loop TRUE }");
  PredefinedMotion motion(scene);
  EXPECT_FALSE(motion.moves({0}));
  EXPECT_THAT(motion.driven_transforms(), IsEmpty());
  EXPECT_EQ(motion.animation(), nullptr);
}

TEST(PredefinedMotion, ATranslationBetweenTwoKeysIsConstantVelocity) {
  const Scene scene = scene_of("DEF A Transform { rotation 0 0 1 1.5707963 children DEF LIFT Transform { } }" + kClock +
                               "ROUTE P.value_changed TO LIFT.set_translation");
  PredefinedMotion motion(scene);
  EXPECT_FALSE(motion.moves({0}));
  ASSERT_TRUE(motion.moves({1}));
  EXPECT_TRUE(motion.stays_rigid({1}));
  EXPECT_FALSE(motion.stays_rigid({0})) << "its LIFT goes up and down in it";
  EXPECT_THAT(motion.driven_transforms(), ElementsAre(ObjectId{1}));
  const auto up = motion.piece({1}, 0.5);
  EXPECT_EQ(up.begin_s, 0.0);
  EXPECT_EQ(up.end_s, 2.0);
  EXPECT_TRUE(up.state.velocity.isApprox(Vec3(-1, 0, 0), 1e-7)) << "its parent is turned by a quarter about z";
  EXPECT_TRUE(up.state.acceleration.isZero(0.0));
  const auto down = motion.piece({1}, 2.0);
  EXPECT_EQ(down.begin_s, 2.0);
  EXPECT_TRUE(down.state.velocity.isApprox(Vec3(1, 0, 0), 1e-7));
  EXPECT_TRUE(motion.rigid_pose({1}, 13.0).position.isApprox(Vec3(-1, 0, 0), 1e-7)) << "13 s is 1 s into a cycle";
  EXPECT_TRUE(motion.transform({1}, 13.0).translation.isApprox(Vec3(0, 1, 0)));
}

TEST(PredefinedMotion, ATurnAboutTheOwnOriginIsConstantAngularVelocity) {
  const Scene scene = scene_of("DEF ARM Transform { translation 5 0 0 }" + kClock + "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion motion(scene);
  const auto piece = motion.piece({0}, 1.0);
  EXPECT_EQ(piece.begin_s, 0.0);
  EXPECT_EQ(piece.end_s, 2.0);
  EXPECT_TRUE(piece.state.angular_velocity_body.isApprox(Vec3(0, kPi / 2, 0), 1e-7));
  EXPECT_TRUE(piece.state.velocity.isZero(0.0));
  EXPECT_EQ(piece.state.position, Vec3(5, 0, 0));
}

// HAND stands 3 m out on ARM, which turns: a circle, which no parabola is. Its pieces stay within what is promised.
TEST(PredefinedMotion, ACircleIsCutIntoPiecesThatMeet) {
  const Scene scene = scene_of("DEF ARM Transform { children DEF HAND Transform { translation 3 0 0 } }" + kClock +
                               "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion motion(scene);
  const double jerk = 3 * std::pow(kPi / 2, 3);
  const double bound = jerk * std::pow(PredefinedMotion::kPiece_s, 3) / 125 + 1e-12;
  double t = 0.25;
  for (int i = 0; i < 2000; ++i) {
    const auto piece = motion.piece({1}, t);
    ASSERT_LE(piece.begin_s, t);
    ASSERT_GT(piece.end_s, t);
    ASSERT_LE(piece.end_s - piece.begin_s, PredefinedMotion::kPiece_s);
    for (const double part : {0.0, 0.2, 0.5, 0.8, 1.0}) {
      const double s = piece.begin_s + part * (piece.end_s - piece.begin_s);
      const Pose at = advance(piece.state, s - piece.begin_s).pose(), there = motion.rigid_pose({1}, s);
      ASSERT_LT((at.position - there.position).norm(), bound) << "t = " << s;
      ASSERT_LT(angle_between(at.orientation, there.orientation), 1e-7) << "t = " << s;
    }
    t = piece.end_s;
  }
}

TEST(PredefinedMotion, PiecesDependOnTimeAloneAndNotOnTheQuestionsBefore) {
  const Scene scene = scene_of("DEF ARM Transform { center 1 0 0 }" + kClock + "ROUTE O.value_changed TO ARM.rotation");
  PredefinedMotion forwards(scene), backwards(scene);
  std::vector<PredefinedMotion::Piece> there, back;
  for (int i = 0; i < 500; ++i) there.push_back(forwards.piece({0}, 0.037 * i));
  for (int i = 499; i >= 0; --i) back.push_back(backwards.piece({0}, 0.037 * i));
  std::ranges::reverse(back);
  for (std::size_t i = 0; i < there.size(); ++i) {
    ASSERT_EQ(there[i].begin_s, back[i].begin_s);
    ASSERT_EQ(there[i].state.position, back[i].state.position);
    ASSERT_EQ(there[i].state.velocity, back[i].state.velocity);
    ASSERT_EQ(there[i].state.orientation.coeffs(), back[i].state.orientation.coeffs());
  }
}

TEST(PredefinedMotion, SaysWhatIsNoRigidBody) {
  const std::string scaled = R"(DEF S ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
    DEF UNEVEN Transform { scale 1 2 1 children DEF TURNS Transform { } }
    DEF EVEN Transform { scale 2 2 2 children DEF TURNS2 Transform { } }
    DEF GROWS Transform { })" + kClock + R"(
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

// ---- the scene graph with it ----

TEST(MovingScene, UpdatesWhatMovesAndNothingElse) {
  std::string body = "DEF LIFT Transform { children Shape { geometry Box { } } }" + kClock + "ROUTE P.value_changed TO LIFT.translation\n";
  for (int i = 0; i < 1000; ++i) body += "Transform { translation " + std::to_string(i) + " 0 0 children Shape { } }\n";
  const Scene scene = scene_of(body);
  MovingScene world(scene);
  (void)world.go_to(0.0);
  const auto before = world.graph().counters();
  for (int i = 1; i <= 100; ++i) {
    EXPECT_EQ(world.go_to(0.01 * i).size(), 2u) << "LIFT and its Shape";
    EXPECT_EQ(world.world_from_local({0}).offset, world.world_from_local({1}).offset);
  }
  EXPECT_EQ(world.graph().counters().poses_updated - before.poses_updated, 100u);
  EXPECT_TRUE(world.world_from_local({1}).offset.isApprox(Vec3(0, 1, 0)));
  (void)world.go_to(0.5);
  EXPECT_TRUE(world.world_from_local({1}).offset.isApprox(Vec3(0, 0.5, 0))) << "backwards too";
  EXPECT_EQ(world.graph().counters().boxes_updated, 0u);
  EXPECT_EQ(world.meshes_built(), 0u) << "nobody asked for a box";
}

TEST(MovingScene, AgreesWithTheScene) {
  const Scene scene = scene_of("DEF A Transform { translation 1 2 3 rotation 1 1 0 0.7 scale 2 1 3 center 1 0 0 children DEF B Transform { rotation 0 1 0 2 } }");
  MovingScene world(scene);
  (void)world.go_to(3.0);
  for (const std::uint32_t i : {0u, 1u}) {
    EXPECT_EQ(world.world_from_local({i}).offset, Vec3(scene.world_from_local({i}).translation()));
    EXPECT_EQ(world.world_from_local({i}).linear, Mat3(scene.world_from_local({i}).linear()));
  }
}

TEST(MovingScene, BoxesHoldWhatIsBelowAndAreMadeWhenAskedFor) {
  const Scene scene = scene_of("DEF LIFT Transform { children [ DEF S Shape { geometry DEF BOX Box { size 2 4 6 } } Transform { translation 10 0 0 children Shape { geometry USE BOX } } ] }"
                               "Shape { geometry Sphere { } }" + kClock + "ROUTE P.value_changed TO LIFT.translation");
  MovingScene world(scene);
  (void)world.go_to(1.0);
  const WorldBox box = world.box(scene.find("LIFT").value());
  EXPECT_EQ(world.meshes_built(), 1u) << "one Box, used twice; the Sphere is not below";
  EXPECT_LE((box.lo - Vec3(-1, -1, -3)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((box.hi - Vec3(11, 3, 3)).cwiseAbs().maxCoeff(), 1e-12);
  (void)world.go_to(2.0);
  EXPECT_LE((world.box(scene.find("LIFT").value()).hi - Vec3(11, 4, 3)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(world.meshes_built(), 1u);
  EXPECT_TRUE(world.box(scene.find("S").value()).contains(Vec3(1, 4, 3)));
}

}  // namespace
}  // namespace peerd
