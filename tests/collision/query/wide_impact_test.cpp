#include "collision/query/wide_impact.hpp"

#include <gtest/gtest.h>

#include "collision/exact/triangle_pair.hpp"
#include "tests/collision/query/wide_kernels.hpp"

namespace peerd::collision::wide_impact_test {

using namespace test;

// Both soups move straight on, without turning: speeds in each tree's own frame, and no slack but for rounding.
WideSpeeds straight(const Vec3& a, const Vec3& b) {
  WideSpeeds speeds{};
  for (std::size_t k = 0; k < 3; ++k) {
    speeds.linear_velocity_a[k] = static_cast<float>(a[static_cast<Eigen::Index>(k)]);
    speeds.linear_velocity_b[k] = static_cast<float>(b[static_cast<Eigen::Index>(k)]);
  }
  speeds.slack_m_s = 1e-5F * static_cast<float>(a.norm() + b.norm());
  return speeds;
}

// Triangles that touch at some sampled time are not ruled out, and not promised to be apart until later.
TEST(WideImpact, RulesOutNoTrianglesThatMeet) {
  Numbers numbers(341);
  constexpr double kWithin_s = 0.5;
  std::size_t meeting = 0, ruled_out = 0;
  for (int i = 0; i < 6; ++i) {
    const Vec3 velocity_a = numbers.point(2.0), velocity_b = numbers.point(2.0);
    const Pose pose_a = random_pose(numbers, 0.5), pose_b = random_pose(numbers, 0.5);
    const WidePair pair(random_soup(64, 0.2, 342), random_soup(64, 0.2, 343), RelativeMotion(pose_a, pose_b));
    const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
    const WideSpeeds speeds = straight(velocity_a, velocity_b);
    OrientationCounters counters;
    for (const WideTree::Leaf& a : pair.tree_a.leaves()) {
      for (const WideTree::Leaf& b : pair.tree_b.leaves()) {
        Masks masks;
        MeetTimes times;
        leaves_may_meet(a, b, motion, speeds, kWithin_s, masks, times);
        for (std::size_t row = 0; row < b.count; ++row) {
          for (std::size_t lane = 0; lane < a.count; ++lane) {
            const bool may = (masks[row] >> lane & 1) != 0;
            ruled_out += !may;
            for (int step = 0; step <= 10; ++step) {
              const double t = kWithin_s * step / 10;
              Triangle of_a = pair.of_a(a.faces[lane]), of_b = pair.b.triangle(b.faces[row]);
              for (Vec3& p : of_a) p += t * velocity_a;
              for (Vec3& p : of_b) p = pair.a_from_b(p + t * velocity_b);
              if (!touch(of_a, of_b, counters)) continue;
              ASSERT_TRUE(may) << t;
              ASSERT_LE(static_cast<double>(times[row][lane]), t + 1e-6);
              ++meeting;
              break;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(meeting, 50u);
  EXPECT_GT(ruled_out, 1000u);
}

TEST(WideImpact, NodesThatApproachMayMeetAndNodesThatPartMayNot) {
  Pose aside;
  aside.position = {6, 0, 0};
  const WidePair pair(random_soup(100, 0.1, 344), random_soup(100, 0.1, 345), RelativeMotion(Pose{}, aside));
  const WideMotion motion(pair.tree_a, pair.tree_b, pair.a_from_b);
  const auto any = [&](const Vec3& velocity_b, float within_s) {
    Masks masks;
    nodes_may_meet(pair.tree_a.node(0), pair.tree_b.node(0), motion, straight({0, 0, 0}, velocity_b), within_s, masks);
    for (const std::uint8_t row : masks) {
      if (row != 0) return true;
    }
    return false;
  };
  EXPECT_TRUE(any({-6, 0, 0}, 1.0F));
  EXPECT_FALSE(any({-6, 0, 0}, 0.25F));
  EXPECT_FALSE(any({6, 0, 0}, 1.0F));
  EXPECT_FALSE(any({0, 0, 0}, 100.0F));
}

}  // namespace peerd::collision::wide_impact_test
