#include "collision/contact/proximity.hpp"

#include <gtest/gtest.h>

#include "tests/collision/shapes.hpp"

namespace peerd::collision::proximity_test {

using test::box;
using test::moving;

struct Case {
  const char* name;
  double distance_m, speed_m_s;  // of q along x
  double expected_s;
};
class Proximity : public testing::TestWithParam<Case> {};
TEST_P(Proximity, OfTwoUnitSpheres) {
  const float edge = 2.0F / std::sqrt(3.0F);  // half diagonal 1
  const Body p = box(edge, edge, edge), q = p;
  const KinematicState at_p = moving(Vec3::Zero()),
                       at_q = moving({GetParam().distance_m, 0, 0}, {GetParam().speed_m_s, 0, 0});
  EXPECT_NEAR(proximity_time_s({p, at_p}, {q, at_q}), GetParam().expected_s, 1e-6);
  EXPECT_NEAR(proximity_time_s({q, at_q}, {p, at_p}), GetParam().expected_s, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Table, Proximity,
                         testing::Values(Case{"OverlapNow", 1.5, 3.0, 0.0}, Case{"Closing", 10.0, -2.0, 4.0},
                                         Case{"PartedCountsTwice", 10.0, 2.0, 8.0}),
                         [](const auto& which) { return std::string(which.param.name); });

TEST(Proximity, NeverMeeting) {
  const Body p = box(1, 1, 1);
  const KinematicState still = moving(Vec3::Zero()), far = moving({10, 0, 0}), passing = moving({10, 3, 0}, {-5, 0, 0});
  EXPECT_EQ(proximity_time_s({p, still}, {p, far}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(proximity_time_s({p, still}, {p, passing}), std::numeric_limits<double>::infinity());
}

TEST(Proximity, CenterOffTheOriginTurnsWithTheBody) {
  TransformFields aside;
  Scene scene = test::scene_of({test::box_mesh(1, 1, 1)});
  Body p = make_body(scene, ObjectId{0});
  p.center = {5, 0, 0};
  KinematicState turned = moving(Vec3::Zero());
  turned.orientation = Quat(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()));
  const Body q = box(1, 1, 1);
  const KinematicState there = moving({0, 15, 0}, {0, -1, 0});
  EXPECT_NEAR(proximity_time_s({p, turned}, {q, there}), 10.0 - std::sqrt(3.0), 1e-6);
}

TEST(Proximity, OfALongWallOnlyWhatComesNear) {
  const Body car = box(4, 1, 2), wall = box(100, 4, 0.5F);
  const KinematicState still = moving({0, 0, -3.75});
  const auto near = [&](const KinematicState& s) { return may_come_near({car, s}, {wall, still}, 0.5, 0.5); };
  const KinematicState along = moving({-30, 0, 0}, {20, 0, 0});
  EXPECT_EQ(proximity_time_s({car, along}, {wall, still}), 0.0) << "what its sphere says";
  EXPECT_FALSE(near(along));
  EXPECT_FALSE(near(moving({-30, 0, 0}, {20, 0, -2.9}))) << "2.5 m away: 1.05 m after half a second";
  EXPECT_TRUE(near(moving({-30, 0, 0}, {20, 0, -4.1})));
  EXPECT_TRUE(near(moving({-30, 0, 0}, {20, 0, 0}, {0, 0, -16.2}))) << "nor is it by its acceleration";
  EXPECT_TRUE(near(moving({-30, 0, -2.01}, {20, 0, 10}))) << "0.49 m away, whichever way it goes";
  EXPECT_FALSE(near(moving({-30, 0, -1.4}, {20, 0, 10})));
}

// A body glides by at a height, from beside the floor: however it goes, it is that near in the end.
TEST(Proximity, WhatSlidesAlongComesNearToo) {
  const Body floor = test::body_of(test::floor_mesh(10, 5));
  const Body flake = test::body_of(test::make_mesh({{0, 0, 0}, {0.02F, 0, 0}, {0, 0, 0.02F}}, {{0, 1, 2}}));
  const KinematicState still = moving(Vec3::Zero());
  for (const double height : {0.04, 0.06, 0.08, 0.095}) {
    for (const double beside : {0.12, 0.3, 1.0}) {
      const KinematicState glides = moving({5.0 + beside, height, 0}, {-4, 0, 0});
      EXPECT_TRUE(may_come_near({flake, glides}, {floor, still}, 0.5, 0.1)) << height << ' ' << beside;
    }
  }
  EXPECT_FALSE(may_come_near({flake, moving({5.3, 0.21, 0}, {-4, 0, 0})}, {floor, still}, 0.5, 0.1));
}

TEST(Proximity, WhatHasNoAnswerMayComeNear) {
  Body car = box(4, 1, 2);
  const KinematicState here = moving(Vec3::Zero()), there = moving({1000, 0, 0});
  EXPECT_FALSE(may_come_near({car, here}, {car, there}, 0.5, 0.5));
  Body unknown = car;
  unknown.unsupported = "whatever";
  EXPECT_TRUE(may_come_near({unknown, here}, {car, there}, 0.5, 0.5));
}

}  // namespace peerd::collision::proximity_test
