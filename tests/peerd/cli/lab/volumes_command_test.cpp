#include "peerd/cli/lab/volumes_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "tests/has_members.hpp"
#include "tests/peerd/cli/outcome.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::volumes_command_test {

using testing::HasSubstr;
using testing::SizeIs;
using testing_support::Outcome;
using testing_support::outcome_of;
using testing_support::ScratchFolder;
using Json = nlohmann::ordered_json;

Outcome volumes(const ScratchFolder& folder, const std::string& body, VolumesOptions options) {
  const auto world = folder.write("world.wrl", "#VRML V2.0 utf8\n" + body);
  return outcome_of([&](auto& out, auto& err) { return run_volumes(world.string(), options, out, err); });
}

constexpr const char* kCube = "DEF CUBE Shape { geometry Box { size 2 2 2 } }\n";

// A cube that does not turn is its own 18-DOP, box and oriented box; its sphere has pi sqrt(3) / 2 of its volume.
TEST(Volumes, OfACubeAreKnown) {
  const ScratchFolder folder;
  const Outcome outcome = volumes(folder, kCube, {.json = true, .curve = true, .steps = 1});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_EQ(json["rotations"], 7);
  ASSERT_THAT(json["shapes"], SizeIs(1));
  const Json& cube = json["shapes"][0];
  EXPECT_THAT(cube, HasMembers(R"({"path": "CUBE", "polygons": 6, "triangles": 12, "vertices": 8})"));
  EXPECT_EQ(cube["box"], Json::parse(R"({"lo": [-1.0, -1.0, -1.0], "hi": [1.0, 1.0, 1.0]})"));
  EXPECT_EQ(cube["hull"]["corners"], 8);
  EXPECT_NEAR(cube["hull"]["volume_m3"], 8.0, 1e-9);
  EXPECT_NEAR(cube["percent"]["18-dop"]["mean"], 100.0, 1e-9);
  EXPECT_NEAR(cube["percent"]["aabb"]["mean"], 100.0, 1e-9);
  EXPECT_NEAR(cube["percent"]["obb"], 100.0, 1e-6);
  EXPECT_NEAR(cube["percent"]["sphere"], 272.07, 0.005);
  EXPECT_THAT(cube["turned"], SizeIs(7));
}

// Turned by an eighth the box has twice the volume, and the 18-DOP is the cube again.
TEST(Volumes, OfATurningCubeAreLarger) {
  const ScratchFolder folder;
  const Json json = volumes(folder, kCube, {.json = true, .curve = true, .steps = 8}).json();
  const Json& cube = json["shapes"][0];
  EXPECT_NEAR(cube["turned"][1][0], 100.0, 1e-6);
  EXPECT_NEAR(cube["turned"][1][1], 200.0, 1e-6);
  EXPECT_NEAR(cube["percent"]["obb"], 100.0, 1e-6) << "it turns with the cube";
  EXPECT_GT(cube["percent"]["aabb"]["mean"], cube["percent"]["18-dop"]["mean"]);
  EXPECT_GT(cube["percent"]["aabb"]["greatest"], 199.0);
}

// A strip of 64 quads in a row: trees of 128 triangles are balanced by any rule that halves.
TEST(Volumes, HierarchiesHaveTheirMeasures) {
  std::string points, quads;
  for (int i = 0; i <= 64; ++i)
    points += std::to_string(i) + " 0 0, " + std::to_string(i) + " 1 " + std::to_string(i % 2) + ", ";
  for (int i = 0; i < 64; ++i) {
    quads += std::to_string(2 * i) + ' ' + std::to_string(2 * i + 2) + ' ' + std::to_string(2 * i + 3) + ' ' +
             std::to_string(2 * i + 1) + " -1 ";
  }
  const ScratchFolder folder;
  const Outcome outcome = volumes(
      folder,
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [" + points + "] } coordIndex [" + quads + "] } }",
      {.json = true,
       .levels = true,
       .steps = 1,
       .hierarchies = {"k=18,rule=longest-side,threshold=1", "k=6,rule=longest-side,threshold=8"}});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json trees = outcome.json()["shapes"][0]["hierarchies"];
  ASSERT_THAT(trees, SizeIs(2));
  EXPECT_THAT(trees[0], HasMembers(R"({"height": 7, "least_height": 7, "nodes": 255})"));
  EXPECT_THAT(trees[0]["level_percent"], SizeIs(8));
  EXPECT_NEAR(trees[0]["level_percent"][0], 100.0, 1e-9);
  EXPECT_THAT(trees[1], HasMembers(R"({"k": 6, "height": 4, "least_height": 4, "nodes": 31})"));
  EXPECT_LT(trees[1]["bytes"], trees[0]["bytes"]);
}

TEST(Volumes, OfTheWholeWorldAreThoseOfOneObject) {
  const ScratchFolder folder;
  const std::string two = "Transform { translation 3 0 0 children " + std::string(kCube) + "}" + kCube;
  const Json apart = volumes(folder, two, {.json = true, .steps = 1}).json();
  EXPECT_THAT(apart["shapes"], SizeIs(2));
  const Json whole = volumes(folder, two, {.json = true, .whole = true, .steps = 1}).json();
  ASSERT_THAT(whole["shapes"], SizeIs(1));
  EXPECT_EQ(whole["shapes"][0]["path"], "");
  EXPECT_EQ(whole["shapes"][0]["polygons"], 12);
  EXPECT_NEAR(whole["shapes"][0]["hull"]["volume_m3"], 5.0 * 2.0 * 2.0, 1e-6);
}

TEST(Volumes, OfFlatShapesAreNone) {
  const ScratchFolder folder;
  const std::string flat =
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] } coordIndex [ 0 1 2 ] } }";
  const Outcome outcome = volumes(folder, flat, {.json = true, .steps = 1, .hierarchies = {"k=14"}});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json shape = outcome.json()["shapes"][0];
  EXPECT_TRUE(shape["hull"].is_null());
  EXPECT_TRUE(shape["percent"].is_null());
  EXPECT_EQ(shape["hierarchies"][0]["height"], 0);
  EXPECT_THAT(volumes(folder, flat, {.steps = 1}).out, HasSubstr("flat"));
}

TEST(Volumes, SaysWhatIsWrong) {
  const ScratchFolder folder;
  const Outcome empty = volumes(folder, "Shape { geometry PointSet { } }", {.json = true});
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_THAT(empty.err, HasSubstr("no polygons that collide"));
  EXPECT_EQ(empty.json()["good"], false);
  const Outcome words = volumes(folder, kCube, {.hierarchies = {"k=7"}});
  EXPECT_EQ(words.exit_code, 2);
  EXPECT_THAT(words.err, HasSubstr("--hierarchy: k=7 is none of"));
}

TEST(Volumes, AsTextAreALineEach) {
  const ScratchFolder folder;
  const Outcome outcome =
      volumes(folder, kCube, {.curve = true, .levels = true, .steps = 1, .hierarchies = {"threshold=4"}});
  EXPECT_THAT(outcome.out, HasSubstr("CUBE: 6 polygons, 12 triangles, 8 vertices\n"));
  EXPECT_THAT(outcome.out, HasSubstr("18-DOP 100.00 %, AABB 100.00 %, OBB 100.00 %, sphere 272.07 %\n"));
  EXPECT_THAT(outcome.out, HasSubstr("k=18,rule=splatter,threshold=4: 2 levels below the root (at least 2)"));
  EXPECT_THAT(outcome.out, HasSubstr("level 0: 100 % of the root's volume"));
  EXPECT_THAT(outcome.out, HasSubstr("rotation 6: "));
}

}  // namespace peerd::volumes_command_test
