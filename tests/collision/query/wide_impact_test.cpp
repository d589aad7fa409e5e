#include "collision/query/wide_impact.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/exact/triangle_pair.hpp"
#include "collision/query/time_of_impact.hpp"
#include "tests/collision/query/oriented_boxes.hpp"

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

// A motion that moves and turns: velocities in the tree's own frame, and a slack that is for rounding alone.
struct Moves {
  Vec3 linear, angular;

  explicit Moves(Numbers& numbers) : linear(rounded(numbers.point(2.0))), angular(rounded(numbers.point(1.0))) {}
  [[nodiscard]] Vec3 at(const Vec3& p) const { return linear + angular.cross(p); }
  [[nodiscard]] double spread(const Parallelepiped& p) const { return angular.norm() * p.half.norm(); }
  // Each point has moved on at its own velocity.
  [[nodiscard]] Parallelepiped after(double seconds, const Parallelepiped& p) const {
    Parallelepiped out = p;
    out.center += seconds * at(p.center);
    for (Vec3& side : out.sides) side += seconds * angular.cross(side);
    return out;
  }

 private:
  static Vec3 rounded(const Vec3& v) { return v.cast<float>().cast<double>(); }
};
WideSpeeds speeds_of(const Moves& a, const Moves& b) {
  WideSpeeds speeds = straight(a.linear, b.linear);
  for (std::size_t k = 0; k < 3; ++k) {
    speeds.angular_velocity_a[k] = static_cast<float>(a.angular[static_cast<Eigen::Index>(k)]);
    speeds.angular_velocity_b[k] = static_cast<float>(b.angular[static_cast<Eigen::Index>(k)]);
  }
  speeds.rate_a = static_cast<float>(a.angular.norm() * 1.000001);
  speeds.rate_b = static_cast<float>(b.angular.norm() * 1.000001);
  speeds.slack_m_s = 0x1p-14F;
  return speeds;
}

// The families of axes along which boxes can be apart.
enum Family : std::size_t { kOfA, kOfB, kProduct, kFamilies };
using Clear = std::array<double, kFamilies>;
// A gap along the best axis of each family outlasts the time by so much, in binary64.
Clear outlasting(const Parallelepiped& a, const Parallelepiped& b, const Vec3& velocity, double spare,
                 double within_s) {
  Clear clear;
  clear.fill(-1.0);
  const auto try_axis = [&](const Vec3& n, Family family) {
    const double toward = n.dot(b.center - a.center) < 0.0 ? -n.dot(velocity) : n.dot(velocity);
    clear[family] = std::max(clear[family], gap_along(a, b, n) - std::max(0.0, (toward + spare) * within_s));
  };
  for (const Vec3& side_a : a.sides) {
    try_axis(side_a, kOfA);
    for (const Vec3& side_b : b.sides) try_axis(side_a.cross(side_b), kProduct);
  }
  for (const Vec3& side_b : b.sides) try_axis(side_b, kOfB);
  return clear;
}

// Oriented boxes of all shapes, which move and turn: those that share a point at some sampled time are kept; those that
// a gap along one of the fifteen axes keeps apart, by more than rounding can hide, are not. Axes of each family are
// needed.
TEST(WideImpact, OrientedBoxesAreToldApartByFifteenAxesAndNeverWrongly) {
  Numbers numbers(346);
  std::size_t meeting = 0;
  std::array<std::size_t, kFamilies> by_one_family{};
  for (int i = 0; i < 400; ++i) {
    const Pose pose_a = random_pose(numbers, 0.5), pose_b = random_pose(numbers, i % 2 ? 2.0 : 0.5);
    const BoxPair pair(numbers, RelativeMotion(pose_a, pose_b), i);
    const Moves moves_a(numbers), moves_b(numbers);
    const double within_s = i % 5 == 0 ? 0.0 : numbers.between(0.0, 0.3);
    Masks masks;
    nodes_may_meet(pair.a, pair.b, pair.motion, speeds_of(moves_a, moves_b), static_cast<float>(within_s), masks);
    for (std::size_t row = 0; row < WideTree::kWidth; ++row) {
      for (std::size_t lane = 0; lane < WideTree::kWidth; ++lane) {
        const Parallelepiped a = exactly(pair.boxes_a[lane]), b = exactly(pair.boxes_b[row]);
        const bool may = (masks[row] >> lane & 1) != 0;
        for (int step = 0; step <= 8 && !may; ++step) {
          const double t = within_s * step / 8;
          ASSERT_GT(separation(moves_a.after(t, a), pair.a_from_b * moves_b.after(t, b)), 0.0) << i << " at " << t;
        }
        meeting += separation(a, pair.a_from_b * b) < 0.0;
        const Vec3 velocity = moves_a.at(a.center) - pair.a_from_b.rotation * moves_b.at(b.center);
        const Clear clear = outlasting(a, pair.a_from_b * b, velocity, moves_a.spread(a) + moves_b.spread(b), within_s);
        const double sure = 4.0 * static_cast<double>(pair.motion.slack_oriented);
        const auto families = std::ranges::count_if(clear, [&](double by) { return by > sure; });
        ASSERT_FALSE(may && families > 0) << i;
        for (std::size_t f = 0; f < kFamilies; ++f) by_one_family[f] += families == 1 && clear[f] > sure;
      }
    }
  }
  EXPECT_GT(meeting, 200u);
  for (const std::size_t pairs : by_one_family) EXPECT_GT(pairs, 50u);
}

// Plates that stand aslant and slide along each other: axis-aligned boxes of their parts overlap, flat ones don't.
TEST(WideImpact, PlatesThatSlideByTakeFewPairs) {
  const TriangleSoup plate = aslant_plate(32);
  WideTree a(plate), b(plate);
  KinematicState above, still;
  above.position = 0.01 * plate_normal();
  above.velocity = plate_normal().cross(Vec3(1, 0, 0));
  MeshImpactQuery query;
  const MeshImpact impact = query.first_impact(a, still, b, above, 0.1);
  EXPECT_EQ(impact.state, MeshImpactState::kSeparated);
  EXPECT_LE(impact.iterations, 4u);
}

TEST(WideImpact, SaysWhatIsTooFarForBinary32) {
  const TriangleSoup ring = torus(4, 6, true);
  WideTree a(ring), b(ring);
  KinematicState still, coming;
  coming.position = {0x1p64, 0, 0};
  MeshImpactQuery query;
  EXPECT_EQ(query.first_impact(a, still, b, coming, 1.0).state, MeshImpactState::kTooLarge);
  EXPECT_EQ(query.first_impact(a, still, b, coming, 1.0).time_s, 0.0);
  coming.position = {0x1p61, 0, 0};
  EXPECT_EQ(query.first_impact(a, still, b, coming, 1.0).state, MeshImpactState::kSeparated);
}

}  // namespace peerd::collision::wide_impact_test
