#include "collision/contact/contact_time.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::contact_time_test {

using namespace test;
using enum CollisionType;

Contact meet(const Body& a, const KinematicState& at_a, const Body& b, const KinematicState& at_b,
             double horizon = 100.0, CollisionType type = kWitness) {
  return first_contact({a, at_a}, {b, at_b}, type, horizon);
}

TEST(ContactTime, BoxMeetsBoxFaceToFace) {
  const Body a = box(1, 1, 1), b = box(2, 2, 2);
  for (const CollisionType type : {kBox, kWitness, kAllPairs}) {
    const Contact c = meet(a, moving({5, 0.2, 0}, {-2, 0, 0}), b, moving(Vec3::Zero()), 10, type);
    ASSERT_EQ(c.state, ContactState::kContact);
    EXPECT_EQ(c.time_s, 1.75);
    EXPECT_EQ(c.normal_world, Vec3::UnitX());
    EXPECT_EQ(c.collidee_shape, type == kBox ? ObjectId{0} : ObjectId{1});
    EXPECT_EQ(c.collidee_polygon, type == kBox ? 0U : 1U);
    EXPECT_EQ(c.iterations, 0U);
    EXPECT_FALSE(c.resting);
  }
}

TEST(ContactTime, FlatPolygonsFaceToFaceAtAnyTilt) {
  const Body a = body_of(wall_mesh(1, 1)), b = body_of(wall_mesh(3, 3));
  std::mt19937_64 rng(3);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Quat q = random_rotation(rng);
    KinematicState s = moving(q * Vec3(2, 0, 0), q * Vec3(-1, 0.1, 0), q * Vec3(i % 2 ? -0.2 : 0.0, 0, 0)),
                   wall = moving(Vec3::Zero());
    s.orientation = wall.orientation = q;
    const Contact c = meet(a, s, b, wall, 10);
    ASSERT_EQ(c.state, ContactState::kContact);
    EXPECT_NEAR(c.time_s, i % 2 ? (std::sqrt(1.8) - 1.0) / 0.2 : 2.0, 1e-12);
    EXPECT_NEAR((c.normal_world - q * Vec3::UnitX()).norm(), 0.0, 1e-14);
  }
}

TEST(ContactTime, CoplanarPolygonsMeetAtTheirSides) {
  const Body a = body_of(wall_mesh(1, 1)), b = body_of(wall_mesh(3, 3));
  const Contact c = meet(a, moving({0, 5, 0}, {0, -1, 0}), b, moving(Vec3::Zero()));
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_EQ(c.time_s, 3.0);
  EXPECT_EQ(c.normal_world, Vec3::UnitY());  // no polygon's normal opposes this: the axis itself
  EXPECT_EQ(meet(a, moving({1e-9, 5, 0}, {0, -1, 0}), b, moving(Vec3::Zero())).state, ContactState::kSeparated);
}

// The collidee meets a face of the collider with its corner: of its own polygons none faces that way.
TEST(ContactTime, ACornerMeetsAFaceAlongTheFace) {
  const Body plate = box(4, 1, 4), tip = box(1, 1, 1);
  KinematicState tilted = moving({0, 3, 0}, {0, -1, 0});
  tilted.orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 0.4, 0).normalized()));
  const Contact c = meet(plate, moving(Vec3::Zero()), tip, tilted);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_EQ(c.separating_normal_world, -Vec3::UnitY());
  EXPECT_GT((c.normal_world + Vec3::UnitY()).norm(), 0.1);
  const Contact turned = meet(tip, tilted, plate, moving(Vec3::Zero()));
  EXPECT_EQ(turned.separating_normal_world, Vec3::UnitY());
  EXPECT_EQ(turned.normal_world, Vec3::UnitY()) << "the plate is the collidee now, and it is its polygon that is met";
}

TEST(ContactTime, InMidAirInARoomNothingTouches) {
  const Body room = box(10, 10, 10), crate = box(1, 1, 1);
  const KinematicState still = moving(Vec3::Zero()), at_wall = moving({4.5, 0, 0});
  EXPECT_FALSE(touching({crate, still}, {room, still}, kWitness));
  EXPECT_TRUE(touching({crate, still}, {room, still}, kWitness, {.as = MeetAs::kSolids}));
  EXPECT_TRUE(touching({crate, at_wall}, {room, still}, kWitness));
}

TEST(ContactTime, EdgeMeetsEdge) {
  const Body a = box(2, 2, 2), b = box(2, 2, 2);
  KinematicState top = moving({0, 10, 0}, {0, -1, 0}), below = moving(Vec3::Zero());
  top.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX()));
  below.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitZ()));
  const Contact c = meet(a, top, b, below);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.time_s, 10.0 - 2.0 * std::sqrt(2.0), 1e-13);
  // +x and +y of the collidee meet at the edge, and both oppose the fall: the lower polygon's normal.
  EXPECT_EQ(c.collidee_polygon, 1U);
  EXPECT_NEAR((c.normal_world - Vec3(1, 1, 0).normalized()).norm(), 0.0, 1e-15);
}

struct StartCase {
  const char* name;
  Vec3 p, v, a;  // of a 1 m cube against a 1 m cube at the origin
  ContactState state;
  double time_s;
  bool resting;
};
class Start : public testing::TestWithParam<StartCase> {};
TEST_P(Start, ByTheTouchingRule) {
  const Body cube = box(1, 1, 1);
  const StartCase& k = GetParam();
  for (const double noise : {0.0, 4e-16, -4e-16}) {
    const Contact c = meet(cube, moving(k.p + Vec3(noise, 0, 0), k.v, k.a), cube, moving(Vec3::Zero()), 10);
    ASSERT_EQ(c.state, k.state);
    EXPECT_NEAR(c.time_s, k.time_s, 1e-12);
    EXPECT_EQ(c.resting, k.resting);
    if (c.state != ContactState::kSeparated) {
      EXPECT_EQ(c.normal_world, Vec3::UnitX());
    }
  }
}
const Vec3 k0 = Vec3::Zero();
constexpr auto S = ContactState::kSeparated, C = ContactState::kContact, O = ContactState::kOverlapped;
INSTANTIATE_TEST_SUITE_P(
    Table, Start,
    testing::Values(StartCase{"Receding", {3, 0, 0}, {1, 0, 0}, k0, S, 0, false},
                    StartCase{"PassesBy", {3, 2, 0}, {-1, 0, 0}, k0, S, 0, false},
                    StartCase{"GlidesAlongWhatItIsFlushWith", {3, 1, 0}, {-1, 0, 0}, k0, S, 0, false},
                    StartCase{"IsPressedOntoWhatItIsFlushWith", {3, 1, 0}, {-1, 0, 0}, {0, -1e-3, 0}, C, 2, false},
                    StartCase{"DoesNotReach", {3, 0, 0}, {-1, 0, 0}, {0.26, 0, 0}, S, 0, false},
                    StartCase{"TouchApproaching", {1, 0, 0}, {-1, 0, 0}, k0, C, 0, false},
                    StartCase{"TouchParting", {1, 0, 0}, {1, 0, 0}, k0, S, 0, false},
                    StartCase{"TouchPartingAndPulledBack", {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, C, 2, false},
                    StartCase{"TouchStill", {1, 0, 0}, k0, k0, S, 0, false},
                    StartCase{"TouchSlidingAlong", {1, 0.5, 0}, {0, 1, 0}, k0, S, 0, false},
                    StartCase{"TouchPressed", {1, 0, 0}, {0, 1, 0}, {-10, 0, 0}, C, 0, true},
                    StartCase{"TouchDrawnAway", {1, 0, 0}, k0, {10, 0, 0}, S, 0, false},
                    StartCase{"BounceTooLowIsRest", {1, 0, 0}, {1e-9, 0, 0}, {-10, 0, 0}, C, 0, true},
                    StartCase{"OverlapParting", {0.75, 0, 0}, {1, 0, 0}, k0, O, 0, false},
                    StartCase{"OverlapApproaching", {0.75, 0, 0}, {-1, 0, 0}, k0, O, 0, false},
                    StartCase{"InsideByLessThanATickOfMotion", {1 - 3e-9, 0, 0}, {4, 0, 0}, k0, S, 0, false},
                    StartCase{"InsideByMoreThanATickOfMotion", {1 - 3e-9, 0, 0}, {2, 0, 0}, k0, O, 0, false}),
    [](const auto& which) { return std::string(which.param.name); });

TEST(ContactTime, SlidesUpASideAndBackWithoutAContact) {
  const Body cube = box(1, 1, 1);
  const Contact c = meet(cube, moving({1, 0, 0}, {0, 2, 0}, {0, -1, 0}), cube, moving(Vec3::Zero()), 10);
  EXPECT_EQ(c.state, ContactState::kSeparated);
}

TEST(ContactTime, EarliestOfSeveralPieces) {
  Scene scene = scene_of({box_mesh(1, 1, 1), box_mesh(4, 1, 1)});
  const Body two = make_body(scene, ObjectId{0}), cube = box(1, 1, 1);
  const Contact c = meet(cube, moving({10, 0, 0}, {-1, 0, 0}), two, moving(Vec3::Zero()));
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_EQ(c.time_s, 7.5);
  EXPECT_EQ(c.collidee_shape, ObjectId{2});
  Scene turned = scene_of({box_mesh(4, 1, 1), box_mesh(1, 1, 1)});
  const Body first = make_body(turned, ObjectId{0});
  const Contact same = meet(cube, moving({10, 0, 0}, {-1, 0, 0}), first, moving(Vec3::Zero()));
  ASSERT_EQ(same.state, ContactState::kContact) << "the later piece is met later, or not at all";
  EXPECT_EQ(same.time_s, 7.5);
  EXPECT_EQ(same.collidee_shape, ObjectId{1});
}

TEST(ContactTime, TurnedBoxesHaveTheirWorldBoxes) {
  const Body cube = box(2, 2, 2);
  KinematicState turned = moving({10, 2.3, 0}, {-1, 0, 0});
  turned.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitZ()));
  EXPECT_EQ(meet(cube, turned, cube, moving(Vec3::Zero())).state, ContactState::kContact);
  turned.position.y() = 2.41421;  // above the cube's corner path, below sqrt(2) + 1 of the boxes
  const Contact c = meet(cube, turned, cube, moving(Vec3::Zero()), 100, kBox);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.time_s, 9.0 - std::sqrt(2.0), 1e-13);
}

TEST(ContactTime, BoxesTouchWhereNoAxisKeepsThemApart) {
  const Body a = box(1, 1, 1);
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(5, -7, 9), Vec3(-5, 7, -9), Vec3(100, 3, -100)}) {
    for (int k = 0; k < 3; ++k) {
      for (const double side : {1.0, -1.0}) {
        const auto apart = [&](double distance) {
          return touching({a, moving(place)}, {a, moving(place + side * distance * Vec3::Unit(k))}, kBox);
        };
        EXPECT_TRUE(apart(0.3)) << k;
        EXPECT_TRUE(apart(1.0)) << k;
        EXPECT_FALSE(apart(1.001)) << k;
      }
    }
  }
}

TEST(ContactTime, TheWidestPlaneBetweenTwo) {
  const Body cube = box(1, 1, 1), room = body_of(make_mesh(box_vertices(9, 9, 9), kBoxFaces));
  const auto plane = widest_parting({cube, moving({1, 3, 0})}, {cube, moving({0, 0, 0})});
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->normal_world, Vec3::UnitY());
  EXPECT_EQ(plane->gap_m, 2.0);
  KinematicState tilted = moving({0, 0, 2});
  tilted.orientation = Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX()));
  const auto edge = widest_parting({cube, moving({0, 0, 0})}, {cube, tilted});
  ASSERT_TRUE(edge);
  EXPECT_TRUE(edge->normal_world.isApprox(-Vec3::UnitZ(), 1e-15));
  EXPECT_NEAR(edge->gap_m, 1.5 - std::sqrt(0.5), 1e-15);
  EXPECT_FALSE(widest_parting({cube, moving({0.9, 0, 0})}, {cube, moving({0, 0, 0})}));
  EXPECT_FALSE(widest_parting({cube, moving({0, 0, 0})}, {room, moving({0, 0, 0})})) << "it is inside";
}

TEST(ContactTime, UnsupportedIsSaidAndBoxAnswersAllTheSame) {
  Faces open = kBoxFaces;
  open.pop_back();
  const Body lidless = body_of(make_mesh(box_vertices(1, 1, 1), open)), cube = box(1, 1, 1);
  const Body half_space = box(1, 1e30F, 1e30F);
  const KinematicState near = moving({3, 0, 0}, {-1, 0, 0}), there = moving(Vec3::Zero());
  EXPECT_EQ(meet(lidless, near, cube, there).state, ContactState::kContact);
  EXPECT_EQ(meet(half_space, near, lidless, there).state, ContactState::kUnsupported);
  EXPECT_EQ(meet(lidless, near, half_space, there).state, ContactState::kUnsupported);
  EXPECT_EQ(meet(lidless, near, cube, there, 10, kBox).time_s, 2.0);
}

// A bar turns about z beside a wall: its tip comes down when sin(t) L/2 reaches the distance.
TEST(TurningContact, BarTurnsIntoAWall) {
  const Body bar = box(4, 0.002F, 0.002F), wall = box(10, 1, 10);
  KinematicState s = moving({0, 2.0, 0});
  s.angular_velocity_body = {0, 0, -1};
  const Contact c = meet(bar, s, wall, moving(Vec3::Zero()), 10);
  ASSERT_EQ(c.state, ContactState::kContact);
  const double truth = std::asin(1.5 / std::hypot(2.0, 0.001)) - std::atan2(0.001, 2.0);
  EXPECT_LE(c.time_s, truth + 1e-7);
  EXPECT_GT(c.time_s, truth - 2e-6);
  EXPECT_EQ(c.normal_world, Vec3::UnitY());
  EXPECT_LT(c.iterations, 30U);
}

TEST(TurningContact, SlowApproachOfAFastSpinDoesNotStall) {
  const Body bar = box(4, 0.5F, 0.5F), wall = box(1, 20, 20);
  KinematicState s = moving({12, 0, 0}, {-0.25, 0, 0});
  s.angular_velocity_body = {0, 0, 8};
  const Contact c = meet(bar, s, wall, moving(Vec3::Zero()), 100);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_GT(c.time_s, 37.0);
  EXPECT_LT(c.time_s, 38.5);
}

TEST(TurningContact, PartingFromATouchIsNoContact) {
  const Body cube = box(1, 1, 1);
  for (const double gap : {-4e-16, 0.0, 1e-7, 9e-7}) {
    KinematicState s = moving({1 + gap, 0, 0}, {2, 0, 0});
    s.angular_velocity_body = {0, 0.3, 0.1};
    EXPECT_EQ(meet(cube, s, cube, moving(Vec3::Zero()), 10).state, ContactState::kSeparated) << gap;
    s.velocity.x() = -2;
    const Contact c = meet(cube, s, cube, moving(Vec3::Zero()), 10);
    EXPECT_EQ(c.state, ContactState::kContact);
    EXPECT_EQ(c.time_s, 0.0);
  }
}

TEST(TurningContact, DeepOverlapIsSaid) {
  const Body cube = box(1, 1, 1);
  KinematicState s = moving({0.5, 0, 0});
  s.angular_velocity_body = {0, 0, 1};
  const Contact c = meet(cube, s, cube, moving(Vec3::Zero()));
  EXPECT_EQ(c.state, ContactState::kOverlapped);
  EXPECT_EQ(c.normal_world, Vec3::UnitX());
}

}  // namespace peerd::collision::contact_time_test
