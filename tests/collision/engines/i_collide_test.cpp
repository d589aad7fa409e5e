#include "collision/engines/i_collide.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/collision/engines/convex_soups.hpp"

namespace peerd::collision::engines::i_collide_test {

using ::testing::ElementsAreArray;

// Boxes whose faces, edges and corners meet exactly, and polyhedra that are in each other.
TEST(ICollideTest, FindsWhatTouchesOfClosedConvexPolyhedra) {
  const TriangleSoup all[] = {closed_box({1, 1, 1}), closed_box({0.5, 0.25, 1}), spindle(5), spindle(12)};
  ICollide engine;
  Numbers numbers(51);
  std::size_t touching = 0;
  constexpr int kQuestions = 2000;
  for (int i = 0; i < kQuestions; ++i) {
    const auto a = static_cast<std::uint64_t>(i % 4), b = static_cast<std::uint64_t>(i / 4 % 4);
    Pose pose = random_pose(numbers, 1.6);
    if (i % 3 == 0) {
      pose = {Vec3((4.0 * pose.position).array().round() / 4.0), Quat::Identity()};
    }
    const RelativeMotion motion(Pose{}, pose);
    const auto expected = brute_force(all[a], all[b], motion);
    touching += expected.empty() ? 0 : 1;
    ASSERT_THAT(engine.all_pairs({a + 1, &all[a]}, {b + 1, &all[b]}, motion), ElementsAreArray(expected)) << i;
    PolygonPair pair{};
    ASSERT_EQ(engine.find_pair({a + 1, &all[a]}, {b + 1, &all[b]}, motion, pair), !expected.empty()) << i;
  }
  EXPECT_GT(touching, kQuestions / 4u);
  EXPECT_LT(touching, kQuestions * 3 / 4u);
}

struct Cost {
  std::uint64_t steps = 0, sort_moves = 0, triangle_tests = 0;
};
Cost operator-(const Cost& a, const Cost& b) {
  return {a.steps - b.steps, a.sort_moves - b.sort_moves, a.triangle_tests - b.triangle_tests};
}
Cost cost_of(const ICollide& engine) {
  return {engine.feature_steps(), engine.sort_moves(), engine.counters().triangle_tests};
}

TEST(ICollideTest, CoherenceSavesSortingOfManyPieces) {
  const TriangleSoup a = torus(12, 30, true), b = torus(10, 20, false);
  ICollide engine;
  Cost first, second;
  for (int i = 0; i < 2; ++i) {
    const Cost before = cost_of(engine);
    const RelativeMotion motion(Pose{}, {Vec3(1.1, 0.9, 0.05 + 1e-5 * i), quat_exp(Vec3(0.3, 0.2, 0.1))});
    EXPECT_THAT(engine.all_pairs({1, &a}, {2, &b}, motion), ElementsAreArray(brute_force(a, b, motion)));
    (i == 0 ? first : second) = cost_of(engine) - before;
  }
  EXPECT_LT(10 * second.sort_moves, first.sort_moves);
  EXPECT_LT(second.steps, first.steps);
}

// What is kept of one pair of soups does not lead another one astray.
TEST(ICollideTest, SoupsWithNewNumbersAreNew) {
  const TriangleSoup box = closed_box({1, 1, 1}), small = closed_box({0.1, 0.1, 0.1}), few = random_soup(4, 0.4, 9);
  ICollide engine;
  const RelativeMotion motion(Pose{}, Pose{Vec3(1.5, 0, 0), Quat::Identity()});
  std::uint64_t number = 10;
  for (const TriangleSoup* soup : {&box, &small, &few, &box}) {
    EXPECT_THAT(engine.all_pairs({1, &box}, {++number, soup}, motion),
                ElementsAreArray(brute_force(box, *soup, motion)));
  }
}

}  // namespace peerd::collision::engines::i_collide_test
