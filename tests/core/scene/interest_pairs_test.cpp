#include "core/scene/interest_pairs.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::interest_pairs_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// "A-B" for each pair of all interests.
std::vector<std::string> pairs_of(const Scene& scene) {
  std::vector<std::string> pairs;
  std::size_t count = 0;
  for (const CollisionInterest& interest : scene.interests) {
    const InterestPairs all(scene, interest);
    count += all.count();
    all.for_each([&](ObjectId a, ObjectId b) { pairs.push_back(scene.path_of(a) + "-" + scene.path_of(b)); });
  }
  EXPECT_EQ(pairs.size(), count);
  return pairs;
}
std::vector<std::string> pairs_of(const std::string& body) { return pairs_of(scene_of(body)); }

const std::string kCrates =
    "DEF CRATES Group { children [ DEF C1 Transform { } Transform { } DEF C3 Transform { } ] }\n";
const std::string kWalls = "DEF WEST Transform { } DEF EAST Transform { }\n";

std::string interest(const std::string& object, const std::string& others, const std::string& more = "") {
  return "CollisionInterest { objectPath \"" + object + "\" interests [ " + others + " ] " + more + " }\n";
}

TEST(InterestPairs, AGroupMeetsItselfAndTheWorld) {
  EXPECT_THAT(
      pairs_of(kCrates + kWalls + interest("CRATES/*", R"("WEST" "CRATES/*")")),
      ElementsAre("CRATES/C1-WEST", "CRATES/C1-CRATES/1", "CRATES/C1-CRATES/C3", "CRATES/1-WEST", "CRATES/1-CRATES/C1",
                  "CRATES/1-CRATES/C3", "CRATES/C3-WEST", "CRATES/C3-CRATES/C1", "CRATES/C3-CRATES/1"));
}

TEST(InterestPairs, AGroupByItsNameIsOneThing) {
  EXPECT_THAT(pairs_of(kCrates + kWalls + interest("WEST", "\"CRATES\"")), ElementsAre("WEST-CRATES"));
}

TEST(InterestPairs, AStarStandsForAnyCharactersOfOneName) {
  const std::string cars =
      "DEF CAR_A Group { children [ DEF WHEEL_L Transform { } DEF WHEEL_R Transform { } DEF DOOR Transform { } ] }\n"
      "DEF CAR_B Group { children [ DEF WHEEL_L Transform { } DEF SEAT Transform { } ] } DEF ROAD Transform { }\n";
  EXPECT_THAT(pairs_of(cars + interest("ROAD", "\"CAR_*/WHEEL*\"")),
              ElementsAre("ROAD-CAR_A/WHEEL_L", "ROAD-CAR_A/WHEEL_R", "ROAD-CAR_B/WHEEL_L"));
  EXPECT_THAT(pairs_of(cars + interest("ROAD", "\"CAR_*/WHEEL_L\"")),
              ElementsAre("ROAD-CAR_A/WHEEL_L", "ROAD-CAR_B/WHEEL_L"));
  EXPECT_THAT(pairs_of(cars + interest("ROAD", "\"CAR_*/1\"")), ElementsAre("ROAD-CAR_A/WHEEL_R", "ROAD-CAR_B/SEAT"));
  EXPECT_THAT(pairs_of(cars + interest("ROAD", "\"*E*L\"")), ElementsAre("ROAD-CAR_A/WHEEL_L", "ROAD-CAR_B/WHEEL_L"))
      << "DEF names stand anywhere";
  EXPECT_THAT(pairs_of(cars + interest("ROAD", "\"CAR_A/*O*\"")), ElementsAre("ROAD-CAR_A/DOOR"));
}

TEST(InterestPairs, AllIsTheTopLevel) {
  for (const char* const all : {"\"*\"", "\"all\""}) {
    EXPECT_THAT(pairs_of(kCrates + kWalls + interest("EAST", all)), ElementsAre("EAST-CRATES", "EAST-WEST"));
  }
  EXPECT_THAT(pairs_of("DEF all Transform { }" + kWalls + interest("EAST", "\"all\"")), ElementsAre("EAST-all"))
      << "as it was before there were patterns";
}

TEST(InterestPairs, ANameWithAStarInItIsThatName) {
  EXPECT_THAT(
      pairs_of("DEF W* Transform { } DEF WEST Transform { } DEF EAST Transform { }" + interest("EAST", "\"W*\"")),
      ElementsAre("EAST-W*"));
}

TEST(InterestPairs, ExceptLeavesOutOnBothSides) {
  EXPECT_THAT(
      pairs_of(kCrates + kWalls + interest("CRATES/*", "\"*\" \"CRATES/*\"", "except [ \"CRATES/1\" \"*ST\" ]")),
      ElementsAre("CRATES/C1-CRATES/C3", "CRATES/C3-CRATES/C1"));
}

TEST(InterestPairs, WhatIsInsideOfSomethingIsPairedWithItByNameAlone) {
  EXPECT_THAT(pairs_of(kCrates + interest("C*", "\"C*\"")), ElementsAre("CRATES/C1-CRATES/C3", "CRATES/C3-CRATES/C1"));
  EXPECT_THAT(pairs_of(kCrates + interest("CRATES", "\"CRATES/C1\"")), ElementsAre("CRATES-CRATES/C1"));
}

TEST(InterestPairs, APatternPairsWhatSharesALayer) {
  const std::string layers =
      "DEF A Transform { collisionLayers 1 } DEF B Transform { collisionLayers 3 } DEF C Transform { collisionLayers 2 "
      "}"
      "DEF D Transform { collisionLayers 0 } DEF E Transform { }\n";
  EXPECT_THAT(pairs_of(layers + interest("A", "\"*\"")), ElementsAre("A-B", "A-E"));
  EXPECT_THAT(pairs_of(layers + interest("A", "\"C\" \"D\"")), ElementsAre("A-C", "A-D")) << "by name";
}

TEST(InterestPairs, APatternInAnInlineBeginsWithAGroupInIt) {
  const Files files{{"a.wrl", kCrates + interest("CRATES/*", "\"CRATES/*\"")},
                    {"b.wrl", kCrates + interest("C*", "\"CRATES/*\"")}};
  const ReadResult a = read_body(kWalls + "Inline { url \"a.wrl\" }", files);
  ASSERT_TRUE(a.scene);
  EXPECT_EQ(pairs_of(*a.scene).size(), 6u);
  const ReadResult b = read_body(kWalls + "Inline { url \"b.wrl\" }", files);
  EXPECT_FALSE(b.scene);
}

TEST(InterestPairs, OfMistakesAreReported) {
  EXPECT_THAT(problems_of(kWalls + interest("WEST", "\"NOWHERE/*\" \"X*\"")),
              ElementsAre("3:51: no node of the scene is named 'NOWHERE'", "warning 3:63: 'X*' finds nothing yet"));
  EXPECT_THAT(problems_of(kWalls + interest("WEST", "\"*\"", "except \"WEST\"")),
              ElementsAre(HasSubstr("'WEST' is the collider")));
  EXPECT_THAT(problems_of(kWalls + interest("*", "\"*\"")), IsEmpty());
}

}  // namespace peerd::interest_pairs_test
