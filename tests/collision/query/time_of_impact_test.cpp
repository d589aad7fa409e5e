#include "collision/query/time_of_impact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "collision/exact/triangle_distance.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::time_of_impact_test {

TriangleSoup soup_of(std::vector<Vec3> vertices, const std::vector<std::array<std::uint32_t, 3>>& faces) {
  TriangleSoup soup;
  soup.vertices = std::move(vertices);
  find_box(soup);
  for (std::uint32_t i = 0; i < faces.size(); ++i) soup.faces.push_back({faces[i], i});
  return soup;
}

TriangleSoup point(const Vec3& p) { return soup_of({p}, {{0, 0, 0}}); }
TriangleSoup rod(const Vec3& p, const Vec3& q) { return soup_of({p, q}, {{0, 1, 1}}); }
TriangleSoup plate(double half) {
  return soup_of({{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}});
}

constexpr double kTolerance = 1e-6;

// Velocities in the world's frame [m/s, rad/s].
KinematicState moving(const Pose& pose, const Vec3& velocity, const Vec3& turn = Vec3::Zero()) {
  KinematicState s = at_rest(pose);
  s.velocity = velocity;
  s.angular_velocity_body = pose.orientation.conjugate() * turn;
  return s;
}

// The answer is never later than the truth, and never earlier than the tolerance at the speed of approach.
void expect_hit(const TriangleSoup& a, const KinematicState& of_a, const TriangleSoup& b, const KinematicState& of_b,
                double truth, double speed, double step = 10.0) {
  WideTree tree_a(a), tree_b(b);
  MeshImpactQuery query;
  const MeshImpact impact = query.first_impact(tree_a, of_a, tree_b, of_b, step, {.tolerance_m = kTolerance});
  ASSERT_EQ(impact.state, MeshImpactState::kHit);
  ASSERT_LE(impact.time_s, truth * (1.0 + 1e-15));
  ASSERT_GE(impact.time_s, truth - 1.1 * kTolerance / speed);
  ASSERT_LE(impact.distance_m, 1.001 * kTolerance);
}

TEST(TimeOfImpact, PointsMeetPlanes) {
  Numbers numbers(61);
  const TriangleSoup floor = plate(100.0);
  for (int i = 0; i < 3000; ++i) {
    // The pair is in a frame of the plate's, which stands and moves anyhow in the world.
    const Pose stand = random_pose(numbers, 5.0);
    const Vec3 drift = numbers.point(1.0);
    const double height = numbers.between(0.01, 5.0), speed = numbers.between(0.6, 50.0);
    Vec3 slide = numbers.point(2.0);
    slide[2] = -speed;
    const KinematicState of_floor = moving(stand, drift);
    const KinematicState of_point =
        moving({stand * Vec3(numbers.between(-9, 9), numbers.between(-9, 9), height), Quat::Identity()},
               drift + stand.orientation * slide);
    expect_hit(floor, of_floor, point({0, 0, 0}), of_point, height / speed, speed);
  }
}

TEST(TimeOfImpact, BoxesMeetFaceToFace) {
  Numbers numbers(62);
  for (int i = 0; i < 3000; ++i) {
    const Pose stand = random_pose(numbers, 5.0);
    const Vec3 half_a(numbers.between(0.1, 2), 1, 1), half_b(numbers.between(0.1, 2), 0.5, 0.5);
    const double gap = numbers.between(0.01, 5.0), speed = numbers.between(0.6, 50.0);
    const Pose there = {stand * Vec3(half_a[0] + half_b[0] + gap, 0.3, -0.2), stand.orientation};
    expect_hit(closed_box(half_a), at_rest(stand), closed_box(half_b),
               moving(there, stand.orientation * Vec3(-speed, 0, 0)), gap / speed, speed);
  }
}

// The lowest vertex of a turned box meets a floor.
TEST(TimeOfImpact, TurnedBoxesMeetTheFloorWithACorner) {
  Numbers numbers(63);
  const TriangleSoup floor = plate(100.0);
  for (int i = 0; i < 2000; ++i) {
    const TriangleSoup block = closed_box({0.5, 0.7, 0.3});
    const Pose turned = random_pose(numbers, 1.0);
    double lowest = 1e9;
    for (const Vec3& v : block.vertices) lowest = std::min(lowest, (turned * v)[2]);
    const double height = numbers.between(0.01, 3.0), speed = numbers.between(0.6, 30.0);
    Pose start = turned;
    start.position[2] += height - lowest;
    expect_hit(floor, {}, block, moving(start, {0, 0, -speed}), height / speed, speed);
  }
}

constexpr double kGravity = 9.81;

KinematicState falling(const Pose& pose, const Vec3& velocity, const Vec3& turn = Vec3::Zero()) {
  KinematicState s = moving(pose, velocity, turn);
  s.acceleration = {0, 0, -kGravity};
  return s;
}

// A point of a spinning rod that stands on its axis: the spin takes it nowhere.
TEST(TimeOfImpact, WhatFallsAndSpinsMeetsTheFloorInTime) {
  Numbers numbers(67);
  const TriangleSoup floor = plate(100.0), pole = rod({0, 0, 0}, {0, 0, 1});
  for (int i = 0; i < 2000; ++i) {
    const double height = numbers.between(0.01, 20.0), up = numbers.between(-5.0, 5.0);
    const double truth = (up + std::sqrt(up * up + 2.0 * kGravity * height)) / kGravity;
    const KinematicState of_pole = falling({{0.1, 0.2, height}, Quat::Identity()}, {numbers.between(-3, 3), 0, up},
                                           {0, 0, numbers.between(-30, 30)});
    expect_hit(floor, {}, pole, of_pole, truth, kGravity * truth - up);
  }
}

// The bodies are as after a bounce: nearer than the tolerance.
TEST(TimeOfImpact, ATouchThatPartsIsNoneUntilItComesBack) {
  Numbers numbers(68);
  const TriangleSoup floor = plate(100.0), cube = closed_box({0.5, 0.5, 0.5});
  WideTree a(floor), b(cube);
  MeshImpactQuery query;
  for (int i = 0; i < 500; ++i) {
    const double gap = numbers.between(0.5, 1.0) * kTolerance, up = numbers.between(0.01, 5.0);
    const KinematicState parting =
        falling({{0, 0, 0.5 + gap}, Quat::Identity()}, {numbers.between(-3, 3), 0, up}, {0, 0, numbers.between(-9, 9)});
    const double truth = (up + std::sqrt(up * up + 2.0 * kGravity * gap)) / kGravity;
    const MeshImpact impact = query.first_impact(a, {}, b, parting, 2.0);
    ASSERT_EQ(impact.state, MeshImpactState::kHit);
    ASSERT_LE(impact.time_s, truth);
    ASSERT_GE(impact.time_s, truth - 1.1 * kTolerance / up);
    ASSERT_FALSE(impact.resting);
    ASSERT_GT(impact.direction[2], 0.999);
  }
}

TEST(TimeOfImpact, WhatSlidesIsFreeAndWhatIsPressedRests) {
  const TriangleSoup floor = plate(100.0), cube = closed_box({0.5, 0.5, 0.5});
  WideTree a(floor), b(cube);
  MeshImpactQuery query;
  const Pose on_it = {{0, 0, 0.5 + 0.7 * kTolerance}, Quat::Identity()};
  const MeshImpact slides = query.first_impact(a, {}, b, moving(on_it, {3, 1, 0}), 2.0);
  EXPECT_EQ(slides.state, MeshImpactState::kSeparated);
  EXPECT_LT(slides.iterations, 1000u);
  for (const KinematicState& pressed :
       {falling(on_it, {3, 1, 0}), falling(on_it, {3, 1, 1e-3}), moving(on_it, {3, 1, 0}, {0, 0, 1})}) {
    const MeshImpact rests = query.first_impact(a, {}, b, pressed, 2.0);
    EXPECT_EQ(rests.state, MeshImpactState::kHit);
    EXPECT_EQ(rests.time_s, 0.0);
    EXPECT_TRUE(rests.resting);
  }
  const MeshImpact driven = query.first_impact(a, {}, b, moving(on_it, {3, 1, -1e-3}), 2.0);
  EXPECT_EQ(driven.time_s, 0.0);
  EXPECT_FALSE(driven.resting);
}

TEST(TimeOfImpact, WhatIsFarAndFastTakesFewLooks) {
  const TriangleSoup wall = plate(0.5), bullet = rod({0, 0, 0}, {0, 0, 0.01});
  WideTree a(wall), b(bullet);
  MeshImpactQuery query;
  const MeshImpact hit = query.first_impact(a, {}, b, moving({{0.1, 0.2, 2e8}, Quat::Identity()}, {0, 0, -1e9}), 0.25);
  EXPECT_EQ(hit.state, MeshImpactState::kHit);
  EXPECT_NEAR(hit.time_s, 0.2, 1e-9);
  EXPECT_LT(hit.iterations, 5000u);
}

// A rod that turns about one end comes to a pin at an angle.
TEST(TimeOfImpact, SpinningRodsMeetPins) {
  Numbers numbers(64);
  for (int i = 0; i < 2000; ++i) {
    const double length = numbers.between(0.5, 3.0), at = numbers.between(0.2, 0.95) * length;
    const double angle = numbers.between(0.05, 6.0), rate = numbers.between(0.7, 40.0);
    const TriangleSoup pin =
        rod({at * std::cos(angle), at * std::sin(angle), -1}, {at * std::cos(angle), at * std::sin(angle), 1});
    expect_hit(rod({0, 0, 0}, {length, 0, 0}), moving(Pose{}, Vec3::Zero(), {0, 0, rate}), pin, {}, angle / rate,
               rate * at);
  }
}

// 1 km in the step, through a plate without thickness; and by it.
TEST(TimeOfImpact, WhatIsFastAndThinDoesNotTunnel) {
  const TriangleSoup wall = plate(0.5), bullet = rod({0, 0, 0}, {0, 0, 0.01});
  WideTree tree_a(wall), tree_b(bullet);
  MeshImpactQuery query;
  const KinematicState of_bullet = moving({{0.1, 0.2, 500}, Quat::Identity()}, {0, 0, -1e5}, {0, 0, 300});
  const MeshImpact hit = query.first_impact(tree_a, {}, tree_b, of_bullet, 0.01);
  EXPECT_EQ(hit.state, MeshImpactState::kHit);
  EXPECT_NEAR(hit.time_s, 0.005, 1e-10);
  EXPECT_LE(hit.time_s, 0.005);
  KinematicState beside = of_bullet;
  beside.position[0] = 0.6;
  const MeshImpact passes = query.first_impact(tree_a, {}, tree_b, beside, 0.01);
  EXPECT_EQ(passes.state, MeshImpactState::kSeparated);
  EXPECT_EQ(passes.time_s, 0.01);
}

// Boxes whose faces touch, turned together so that rounding leaves a gap or an overlap: the motion tells.
TEST(TimeOfImpact, TouchingAtTheStartIsToldByTheMotion) {
  const TriangleSoup cube = closed_box({1, 1, 1});
  WideTree left(cube), right(cube);
  MeshImpactQuery query;
  Numbers numbers(70);
  for (int i = 0; i < 200; ++i) {
    const Vec3 axis(numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(-1, 1));
    const Quat turn = i == 0 ? Quat::Identity() : Quat(Eigen::AngleAxisd(numbers.between(-3, 3), axis.normalized()));
    const double far = i % 3 == 0 ? 0.0 : numbers.between(-1e6, 1e6);
    const Vec3 place(far, -far, 0.5 * far);
    const KinematicState a = at_rest({place, turn});
    KinematicState b = at_rest({place + turn * Vec3(2, 0.3, 0.1), turn});
    EXPECT_EQ(query.first_impact(left, a, right, b, 1.0).state, MeshImpactState::kSeparated) << i;
    b.velocity = turn * Vec3(1, 0.5, 0);
    EXPECT_EQ(query.first_impact(left, a, right, b, 1.0).state, MeshImpactState::kSeparated) << i;
    b.velocity = turn * Vec3(-1, 0.5, 0);
    const MeshImpact comes = query.first_impact(left, a, right, b, 1.0);
    EXPECT_EQ(comes.state, MeshImpactState::kHit) << i;
    EXPECT_EQ(comes.time_s, 0.0);
    EXPECT_FALSE(comes.resting);
    EXPECT_NEAR((comes.direction - turn * Vec3::UnitX()).norm(), 0.0, 1e-12) << i;
    b.velocity.setZero();
    b.acceleration = turn * Vec3(-9.81, 0, 0);
    const MeshImpact pressed = query.first_impact(left, a, right, b, 1.0);
    EXPECT_EQ(pressed.state, MeshImpactState::kHit) << i;
    EXPECT_TRUE(pressed.resting);
    EXPECT_NEAR((pressed.direction - turn * Vec3::UnitX()).norm(), 0.0, 1e-12) << i;
    b.position = place + turn * Vec3(2.0 - 1e-6, 0.3, 0.1);
    EXPECT_EQ(query.first_impact(left, a, right, b, 1.0).state, MeshImpactState::kOverlapped) << i;
  }
}

TEST(TimeOfImpact, SaysHowFarItCameWhereItDidNotFind) {
  const TriangleSoup cube = closed_box({1, 1, 1});
  WideTree left(cube), right(cube);
  MeshImpactQuery query;
  const KinematicState coming = moving({{9, 0, 0}, Quat::Identity()}, {-1, 0.1, 0}, {1, 2, 3});
  const MeshImpact failed = query.first_impact(left, {}, right, coming, 10.0, {.max_iterations = 20});
  EXPECT_EQ(failed.state, MeshImpactState::kIterationLimit);
  const MeshImpact found = query.first_impact(left, {}, right, coming, 10.0);
  EXPECT_EQ(found.state, MeshImpactState::kHit);
  EXPECT_LE(failed.time_s, found.time_s);
}

// At these sizes, binary32 knows places to less than the tolerance, and could decide that they touch later.
TEST(TimeOfImpact, WhatIsSmallHitsBeforeItIsNearerThanHalfTheTolerance) {
  Numbers numbers(69);
  for (int i = 0; i < 500; ++i) {
    const double size = 1e-3, gap = numbers.between(2.0, 500.0) * kTolerance, speed = numbers.between(1e-3, 1.0);
    const KinematicState coming = moving({{0, 0, 0.5 * size + gap}, Quat::Identity()}, {0, 0, -speed});
    const TriangleSoup ground = plate(10.0 * size), block = closed_box({0.5 * size, 0.5 * size, 0.5 * size});
    WideTree floor(ground), cube(block);
    MeshImpactQuery query;
    const MeshImpact impact = query.first_impact(floor, {}, cube, coming, 10.0, {.tolerance_m = kTolerance});
    ASSERT_EQ(impact.state, MeshImpactState::kHit);
    ASSERT_GE(impact.distance_m, 0.499 * kTolerance);
    ASSERT_LE(impact.time_s, gap / speed);
  }
  const TriangleSoup floor = plate(0.01), cube = closed_box({5e-4, 5e-4, 5e-4});
  WideTree a(floor), b(cube);
  MeshImpactQuery query;
  const MeshImpact rests =
      query.first_impact(a, {}, b, falling({{0, 0, 5e-4 + 0.7 * kTolerance}, Quat::Identity()}, {0, 0, 0}), 2.0);
  EXPECT_EQ(rests.state, MeshImpactState::kHit);
  EXPECT_EQ(rests.time_s, 0.0);
  EXPECT_TRUE(rests.resting);
}

// Random meshes on random ways, against the exact test at many instants.
TEST(TimeOfImpact, IsBeforeTheFirstInstantThatTouches) {
  Numbers numbers(65);
  const TriangleSoup soup = random_soup(60, 0.3, 66), ring = torus(8, 12, true);
  WideTree a(soup), b(ring);
  MeshImpactQuery query;
  WideQuery exact;
  int hits = 0;
  for (int i = 0; i < 80; ++i) {
    const KinematicState of_a = moving(random_pose(numbers, 1.0), numbers.point(2.0), numbers.point(3.0));
    KinematicState of_b = moving(random_pose(numbers, 1.0), numbers.point(2.0), numbers.point(3.0));
    of_b.position += Vec3(4, 0, 0);
    of_b.velocity += Vec3(-3, 0, 0);
    const MeshImpact impact = query.first_impact(a, of_a, b, of_b, 1.0);
    ASSERT_NE(impact.state, MeshImpactState::kIterationLimit);
    PolygonPair pair{};
    for (int n = 0; n <= 200; ++n) {
      const double t = n / 200.0;
      if (!exact.find_pair(a, b, RelativeMotion(advance(of_a, t).pose(), advance(of_b, t).pose()), pair)) continue;
      ASSERT_NE(impact.state, MeshImpactState::kSeparated) << i << " at " << t;
      ASSERT_LE(impact.time_s, t);
      ++hits;
      break;
    }
  }
  EXPECT_GT(hits, 10);
}

// A hit is reported earlier where the world's coordinates are so large that places are known less well than the
// tolerance: at 1e10 m, a unit in the last place is 2e-6 m. A hit must never touch already.
TEST(TimeOfImpact, CubesThatTumbleOntoAPlateFarOutDoNotTouchItWhenTheyHit) {
  const TriangleSoup cube = closed_box({0.5, 0.5, 0.5}),
                     plate = soup_of({{-20, 0, -20}, {-20, 0, 20}, {20, 0, 20}, {20, 0, -20}}, {{0, 1, 2}, {0, 2, 3}});
  WideTree of_cube(cube), of_plate(plate);
  MeshImpactQuery query;
  WideQuery exact;
  Numbers numbers(91);
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 place(1e10, 1e10 * (i % 2), -1e10);
    KinematicState falls, lies;
    lies.position = place;
    falls.position = place + Vec3(numbers.between(-3, 3), 3.0, numbers.between(-3, 3));
    falls.orientation = random_pose(numbers, 1.0).orientation;
    falls.velocity = {numbers.between(-1, 1), -2.0, numbers.between(-1, 1)};
    falls.angular_velocity_body = numbers.point(3.0);
    const MeshImpact impact = query.first_impact(of_cube, falls, of_plate, lies, 3.0);
    ASSERT_EQ(impact.state, MeshImpactState::kHit) << i;
    PolygonPair pair{};
    const RelativeMotion then(advance(falls, impact.time_s).pose(), advance(lies, impact.time_s).pose());
    EXPECT_FALSE(exact.find_pair(of_cube, of_plate, then, pair)) << i << " at " << impact.time_s;
    ++hits;
  }
  EXPECT_EQ(hits, 300);
}

}  // namespace peerd::collision::time_of_impact_test
