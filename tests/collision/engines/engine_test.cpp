#include "collision/engines/engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::engine_test {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

constexpr const char* kExact[] = {"kdop,k=6",
                                  "kdop,k=14,rule=min-sum",
                                  "kdop,k=26,threshold=1,build=whole",
                                  "kdop,realign=boundary",
                                  "kdop,k=26,realign=hull",
                                  "quickcd",
                                  "obb",
                                  "aabb",
                                  "rapid-world",
                                  "i-collide"};

// Two soups at places where about half of the pairs touch, numbered.
struct Pair {
  TriangleSoup a, b;
  NumberedSoup numbered_a, numbered_b;
  Pair(std::uint32_t i, std::uint32_t triangles)
      : a(random_soup(1 + i % triangles, 0.8, 2 * i)),
        b(random_soup(1 + (i * 7) % triangles, 0.8, 2 * i + 1)),
        numbered_a{2 * i + 1, &a},
        numbered_b{2 * i + 2, &b} {}
};

// 10,000 soups in all, each engine against the triangles one by one.
TEST(Engines, ExactOnesFindWhatTouches) {
  constexpr std::uint32_t kPairs = 5000;
  std::vector<Engine> all;
  for (const char* words : kExact) all.push_back(make_engine(words).value());
  Numbers numbers(39);
  std::uint32_t touching = 0;
  for (std::uint32_t i = 0; i < kPairs; ++i) {
    const Pair soups(i, 12);
    const RelativeMotion motion(random_pose(numbers, 1.0), random_pose(numbers, 1.0));
    const auto expected = brute_force(soups.a, soups.b, motion);
    touching += expected.empty() ? 0 : 1;
    for (const Engine& engine : all) {
      const auto found = engine.narrow_phase->all_pairs(soups.numbered_a, soups.numbered_b, motion);
      ASSERT_THAT(found, ElementsAreArray(expected)) << engine.description.name << ", pair " << i;
      PolygonPair one{~0u, ~0u};
      ASSERT_EQ(engine.narrow_phase->find_pair(soups.numbered_a, soups.numbered_b, motion, one), !expected.empty());
      ASSERT_TRUE(expected.empty() || std::ranges::binary_search(expected, one));
    }
  }
  EXPECT_GT(touching, kPairs / 4);
  EXPECT_LT(touching, kPairs * 3 / 4);
}

TEST(Engines, TheLargestCoordinatesAreNoSpecialCase) {
  const TriangleSoup ground = half_space(), things = random_soup(50, 0.4, 3);
  Numbers numbers(40);
  std::size_t touching = 0;
  for (int i = 0; i < 40; ++i) {
    const RelativeMotion motion(Pose{}, random_pose(numbers, 1.5));
    const auto expected = brute_force(ground, things, motion);
    touching += expected.empty() ? 0 : 1;
    for (const char* words : kExact) {
      const Engine engine = make_engine(words).value();
      EXPECT_THAT(engine.narrow_phase->all_pairs({1, &ground}, {2, &things}, motion), ElementsAreArray(expected))
          << words;
    }
  }
  EXPECT_GT(touching, 5u);
}

TEST(Engines, AreChosenByWords) {
  for (const EngineDescription& each : engines()) {
    const auto made = make_engine(each.name);
    ASSERT_TRUE(made) << each.name;
    EXPECT_EQ(made->description.name, each.name);
    EXPECT_EQ(made->narrow_phase == nullptr, each.name == "ours");
  }
  EXPECT_FALSE(make_engine("sphere")->description.is_exact);
  EXPECT_EQ(make_engine("rapid-world")->broad_phase, BroadPhaseMethod::kSweepAndPrune);
}

TEST(Engines, OptionsOfTreesAreWords) {
  const auto options = kdop_options("rule=min-sum,k=14");
  ASSERT_TRUE(options) << options.error();
  EXPECT_EQ(options->k, 14u);
  EXPECT_EQ(options->tree, (TreeOptions{.rule = SplitRule::kMinSum}));
  EXPECT_EQ(kdop_options("")->k, 18u);
  EXPECT_TRUE(kdop_options("build=whole")->whole);
  EXPECT_FALSE(kdop_options("build=lazy")->whole);
  EXPECT_THAT(kdop_options("k=5").error(), HasSubstr("k=5 is none of"));
}

struct Refused {
  const char *words, *why;
};
class RefusedEngines : public testing::TestWithParam<Refused> {};
TEST_P(RefusedEngines, SayWhy) {
  const auto made = make_engine(GetParam().words);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error(), HasSubstr(GetParam().why));
}
INSTANTIATE_TEST_SUITE_P(
    Table, RefusedEngines,
    testing::Values(Refused{"obbb", "did you mean obb?"}, Refused{"", "there is no engine"},
                    Refused{"kdop,k=7", "k=7 is none of"}, Refused{"kdop,k=x", "no whole number"},
                    Refused{"kdop,threshold=0", "is not 1 to"}, Refused{"kdop,build=now", "neither lazy nor whole"},
                    Refused{"kdop,realign=all", "is none of slabs,"},
                    Refused{"kdop,rule=best", "is none of longest-side"},
                    Refused{"kdop,colour=red", "no option colour"}, Refused{"kdop,k", "is no option=value"},
                    Refused{"kdop,k=6,k=14", "given twice"}, Refused{"obb,k=6", "has no options"},
                    Refused{"sphere,bounds=some", "is none of space-time, none"},
                    Refused{"sphere,depth=65", "is not 0 to 64"}, Refused{"sphere,depth=x", "no whole number"},
                    Refused{"sphere,k=6", "it has bounds and depth"},
                    Refused{"cylinders,axis=y", "none of world, model"}, Refused{"cylinders,k=6", "it has axis"}));

}  // namespace peerd::collision::engines::engine_test
