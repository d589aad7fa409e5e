#include "collision/engines/sphere_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::sphere_query_test {

using ::testing::IsSubsetOf;

// Hubbard's refinement can end at any level: the deeper it comes, the fewer touches there are, and none that is one is
// ever lost.
TEST(SphereQuery, TakesLessForATouchTheDeeperItGoes) {
  constexpr std::uint32_t kDepths[] = {0, 1, 2, 3, 4, 6, 9, SphereQuery::kNoLimit};
  Numbers numbers(17);
  std::vector<std::size_t> taken(std::size(kDepths)), tests(std::size(kDepths));
  std::size_t touching = 0;
  for (std::uint32_t i = 0; i < 600; ++i) {
    const TriangleSoup a = random_soup(1 + i % 40, 0.4, 2 * i), b = random_soup(1 + i * 7 % 40, 0.4, 2 * i + 1);
    const RelativeMotion motion(random_pose(numbers, 2.0), random_pose(numbers, 2.0));
    const auto expected = brute_force(a, b, motion);
    touching += expected.empty() ? 0 : 1;
    bool touched = true;
    for (std::size_t d = 0; d < std::size(kDepths); ++d) {
      SphereQuery query(kDepths[d]);
      PolygonPair pair{};
      const bool now = query.find_pair({1, &a}, {2, &b}, motion, pair);
      ASSERT_TRUE(touched || !now) << i << ", depth " << kDepths[d];
      ASSERT_TRUE(now || expected.empty()) << i << ", depth " << kDepths[d];
      ASSERT_EQ(query.all_pairs({1, &a}, {2, &b}, motion).empty(), !now);
      touched = now;
      taken[d] += now ? 1 : 0;
      tests[d] += query.counters().bv_tests;
    }
    ASSERT_THAT(expected, IsSubsetOf(SphereQuery().all_pairs({1, &a}, {2, &b}, motion)));
  }
  EXPECT_GT(taken.front(), taken[3]);
  EXPECT_GT(taken[3], taken.back());
  EXPECT_GT(taken.back(), touching);
  EXPECT_LT(tests.front(), tests[3]);
  EXPECT_LT(tests[3], tests.back());
}

TEST(SphereQuery, NamesASphereByTheFirstOfItsPolygons) {
  const TriangleSoup soup = random_soup(20, 0.5, 3);
  std::uint32_t first = ~0u;
  for (const TriangleSoup::Face& face : soup.faces) first = std::min(first, face.polygon);
  SphereQuery query(0);
  const auto pairs = query.all_pairs({1, &soup}, {1, &soup}, RelativeMotion(Pose{}, Pose{}));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0], (PolygonPair{first, first}));
}

}  // namespace peerd::collision::engines::sphere_query_test
