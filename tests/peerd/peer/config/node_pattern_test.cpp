#include "peerd/peer/config/node_pattern.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/reader.hpp"
#include "tests/must.hpp"

namespace peerd::config::node_pattern_test {

using testing::ElementsAre;

struct Case {
  const char *pattern, *text;
  bool matches;
};
class PatternTest : public testing::TestWithParam<Case> {};
TEST_P(PatternTest, Matches) { EXPECT_EQ(matches(GetParam().pattern, GetParam().text), GetParam().matches); }
INSTANTIATE_TEST_SUITE_P(
    Table, PatternTest,
    testing::Values(Case{"", "", true}, Case{"", "a", false}, Case{"*", "", true}, Case{"*", "abc", true},
                    Case{"*", "a/b", false}, Case{"*/*", "a/b", true}, Case{"?", "a", true}, Case{"?", "", false},
                    Case{"?", "/", false}, Case{"CAR_*", "CAR_", true}, Case{"CAR_*", "CAR_12", true},
                    Case{"CAR_*", "CAR", false}, Case{"CAR_*", "XCAR_1", false}, Case{"CAR_?", "CAR_12", false},
                    Case{"*_1", "A_1_1", true}, Case{"*a*b", "xaxbxab", true}, Case{"*a*b", "xaxbxa", false},
                    Case{"a**b", "ab", true}, Case{"a/*/c", "a/b/c", true}, Case{"a/*/c", "a/b/b/c", false},
                    Case{"a*c", "a/c", false}, Case{"a*", "a/", false}));

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR_B Transform { children DEF WHEEL_1 Transform { } }
DEF CAR_A Transform { children [ DEF WHEEL_2 Transform { } DEF CAR_C Transform { } ] }
DEF VAN Transform { }
DEF TRUCK Transform { children USE VAN }
PROTO P [ ] { Transform { children DEF CAR_INSIDE Transform { } } }
DEF PLANE P { }
DEF ST*R Transform { }
DEF STAR Transform { }
)";

class FindObjects : public testing::Test {
 protected:
  std::vector<std::string> paths(const char* pattern) {
    const auto found = find_objects(scene, pattern, "k");
    if (!found) return {found.error().text};
    std::vector<std::string> all;
    for (const ObjectId id : *found) all.push_back(scene.path_of(id));
    return all;
  }
  Scene scene = read_world(kWorld).scene.value();
};

TEST_F(FindObjects, ByNameWhereverTheyStandInTheOrderOfTheWorld) {
  EXPECT_THAT(paths("CAR_*"), ElementsAre("CAR_B", "CAR_A", "CAR_A/CAR_C")) << "and not what is inside of a PROTO";
  EXPECT_THAT(paths("WHEEL_?"), ElementsAre("CAR_B/WHEEL_1", "CAR_A/WHEEL_2"));
  EXPECT_THAT(paths("V?N"), ElementsAre("VAN", "TRUCK/VAN")) << "each USE of it";
}
TEST_F(FindObjects, ByPath) {
  EXPECT_THAT(paths("CAR_?/*"), ElementsAre("CAR_B/WHEEL_1", "CAR_A/WHEEL_2", "CAR_A/CAR_C"));
  EXPECT_THAT(paths("CAR_A/W*"), ElementsAre("CAR_A/WHEEL_2"));
  EXPECT_THAT(paths("CAR_A"), ElementsAre("CAR_A"));
}
TEST_F(FindObjects, ANameWithAStarIsItself) { EXPECT_THAT(paths("ST*R"), ElementsAre("ST*R")); }
TEST_F(FindObjects, NoneIsAnErrorWithItsPlace) {
  EXPECT_THAT(paths("BUS_*"), ElementsAre("error: k: no object of the world is called like \"BUS_*\""));
  EXPECT_EQ(error_of(find_objects(scene, {"TRUKC", "f.toml:3:4: "}, "k")).text,
            "f.toml:3:4: error: k: the world has no object \"TRUKC\"; did you mean \"TRUCK\"?");
  EXPECT_EQ(find_objects(scene, {"B*", "f.toml:3:4: "}, "k").error().text.substr(0, 12), "f.toml:3:4: ");
}

}  // namespace peerd::config::node_pattern_test
