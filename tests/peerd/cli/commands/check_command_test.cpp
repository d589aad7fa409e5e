#include "peerd/cli/commands/check_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/core/gzip_text.hpp"
#include "tests/has_members.hpp"
#include "tests/must.hpp"
#include "tests/peerd/cli/outcome.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::check_command_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing_support::keys_of;
using testing_support::Outcome;
using testing_support::outcome_of;
using testing_support::ScratchFolder;
using Json = nlohmann::ordered_json;

constexpr std::string_view kHeader = "#VRML V2.0 utf8\n";

Outcome check(const std::filesystem::path& world, const CheckOptions& options) {
  return outcome_of([&](auto& out, auto& err) { return run_check(world.string(), options, out, err); });
}
Outcome check(const std::filesystem::path& world, bool json, std::uint32_t expansion = 1) {
  return check(world, {.reading = {.expansion = expansion}, .json = json, .copy = {}, .at_s = {}});
}
Outcome check(const ScratchFolder& folder, std::string_view body, bool json, std::uint32_t expansion = 1) {
  return check(folder.write("world.wrl", std::string(kHeader) + std::string(body)), json, expansion);
}
Json json_of(const ScratchFolder& folder, std::string_view body) { return check(folder, body, true).json(); }

constexpr std::string_view kFlawed = R"(
DEF HULL Transform { children DEF SKIN Shape { geometry IndexedFaceSet {
  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0.5, 0 1 0, 2 0 0 ] }
  coordIndex [ 0 1 2 3 -1, 0 1 4 -1, 3 2 1 0 -1 ] } } }
Transform { translation 9 0 0 children USE HULL }
)";

const auto kTopLevel =
    ElementsAre("world", "good", "errors", "warnings", "unsupported", "format", "lengths", "lengths_doubted",
                "statistics", "defects", "closed", "inside", "files", "bytes", "read_ms", "defects_ms");

TEST(Check, SaysHowItUnderstandsTheLengthsOfAFile) {
  const ScratchFolder folder;
  const auto large = folder.write("large.off", "OFF\n3 1 0\n0 0 0\n2000 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome guessed = check(large, false);
  EXPECT_EQ(guessed.exit_code, 0);
  EXPECT_THAT(guessed.out, HasSubstr("OFF: taken as metres: the format says no unit, --unit does; taken as +Y up"));
  EXPECT_THAT(guessed.err, HasSubstr("it is 2000 m large; if its unit is another one, say so: --unit mm"));
  const Json told = check(large, {.reading = {.unit = "mm", .up = "z"}, .json = true, .copy = {}, .at_s = {}}).json();
  EXPECT_EQ(told["format"], "OFF");
  EXPECT_EQ(told["lengths"], "the unit is as asked for; the axis that points up is as asked for");
  EXPECT_EQ(told["lengths_doubted"], "");
  const auto small = folder.write("small.off", "OFF\n3 1 0\n0 0 0\n0.0002 0 0\n0 1e-5 0\n3 0 1 2\n");
  const std::string advice = check(small, false).err;
  EXPECT_THAT(advice, HasSubstr("it is 0.0002 m large, and no unit of --unit is larger than m: an Inline of it"));
  EXPECT_THAT(advice, testing::Not(HasSubstr("--unit m,")));
  EXPECT_EQ(json_of(folder, "Shape { }")["format"], "VRML97");
}

TEST(Check, JsonOfAGoodWorldCountsAll) {
  const ScratchFolder folder;
  const Outcome run = check(folder, kFlawed, true);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
  const Json json = run.json();
  EXPECT_THAT(keys_of(json), kTopLevel);
  EXPECT_EQ(json["world"], (folder / "world.wrl").string());
  EXPECT_EQ(json["good"], true);
  EXPECT_EQ(json["errors"], Json::array());
  EXPECT_EQ(json["warnings"], Json::array());
  EXPECT_EQ(json["unsupported"], Json::array());
  EXPECT_EQ(json["files"], 1);
  EXPECT_EQ(json["bytes"], kHeader.size() + kFlawed.size());
  EXPECT_GT(json["read_ms"], 0.0);
  EXPECT_GE(json["defects_ms"], 0.0);

  const Json& s = json["statistics"];
  EXPECT_THAT(keys_of(s),
              testing::IsSupersetOf({"nodes", "instances", "groups", "shapes", "depth", "geometries", "polygons",
                                     "triangles", "faces", "face_triangles", "polygons_instanced",
                                     "triangles_instanced", "interests", "key_sensors", "routes", "pending_inlines"}));
  EXPECT_THAT(s, HasMembers(R"(
    {"groups": 3, "shapes": 2, "depth": 3, "polygons": 3, "triangles": 5, "polygons_instanced": 6})"));

  const Json& d = json["defects"];
  EXPECT_THAT(keys_of(d),
              ElementsAre("degenerate", "duplicate", "non_planar", "warped", "non_manifold", "non_manifold_edges",
                          "boundary_edges", "same_direction_edges", "edges_without_length", "first"));
  EXPECT_THAT(d, HasMembers(R"(
    {"degenerate": 1, "duplicate": 1, "non_planar": 2, "warped": 2, "non_manifold": 3,
    "non_manifold_edges": 1, "boundary_edges": 2})"));
  EXPECT_EQ(d["first"]["duplicate"], (Json{{"shape", "HULL/SKIN"}, {"polygon", 2}}));
  EXPECT_EQ(d["first"]["degenerate"]["polygon"], 1);
}

// What no peer does is a warning, and the world stays good.
TEST(Check, WhatDoesNothingIsAWarning) {
  const ScratchFolder folder;
  const Outcome run = check(folder,
                            "DEF CAR Transform { children Shape { geometry Box { } } }\nDEF CLOCK TimeSensor { "
                            "}\nROUTE CAR.notColliding TO CLOCK.enabled\n",
                            true);
  EXPECT_EQ(run.exit_code, 0);
  const Json json = run.json();
  EXPECT_EQ(json["good"], true);
  ASSERT_EQ(json["warnings"].size(), 1U);
  EXPECT_EQ(json["warnings"][0]["line"], 4);
  EXPECT_EQ(json["warnings"][0]["column"], 11);
  EXPECT_THAT(json["warnings"][0]["message"].get<std::string>(), HasSubstr("this ROUTE from notColliding"));
  EXPECT_THAT(check(folder / "world.wrl", false).out, HasSubstr(": good, 1 warning; "));
}

TEST(Check, JsonOfAWorldWithoutDefectsHasZeros) {
  const ScratchFolder folder;
  const Json defects = json_of(folder, "Shape { geometry Box {} }")["defects"];
  for (const auto& [key, value] : defects.items()) {
    EXPECT_TRUE(key == "first" || value == 0) << key;
  }
  for (const auto& [key, value] : defects["first"].items()) EXPECT_TRUE(value.is_null()) << key;
}

TEST(Check, JsonOfABadWorldHasEachErrorAndItsPlace) {
  const ScratchFolder folder;
  const Outcome run = check(folder, "Shape { geometry Box { syze 1 1 1 } }\nTransform { translaton 1 2 3 }\n", true);
  EXPECT_EQ(run.exit_code, 1);
  const Json json = run.json();
  EXPECT_THAT(keys_of(json), kTopLevel);
  EXPECT_EQ(json["good"], false);
  ASSERT_EQ(json["errors"].size(), 2U);
  EXPECT_THAT(keys_of(json["errors"][0]), ElementsAre("file", "line", "column", "message"));
  EXPECT_EQ(json["errors"][0]["file"], json["world"]);
  EXPECT_EQ(json["errors"][0]["line"], 2);
  EXPECT_EQ(json["errors"][1]["line"], 3);
  EXPECT_EQ(json["errors"][1]["column"], 13);
  EXPECT_THAT(json["errors"][1]["message"].get<std::string>(), HasSubstr("did you mean 'translation'?"));
  EXPECT_TRUE(json["statistics"].is_null());
  EXPECT_TRUE(json["defects"].is_null());
}

TEST(Check, AnErrorInsideAnInlineIsNamedByTheInnerFile) {
  const ScratchFolder folder;
  const auto inner = folder.write("inner.wrl", std::string(kHeader) + "\nShape { geometry Bx {} }\n");
  const Json json = json_of(folder, "Inline { url \"inner.wrl\" }");
  EXPECT_EQ(json["files"], 2);
  ASSERT_EQ(json["errors"].size(), 1U);
  EXPECT_EQ(json["errors"][0]["file"], std::filesystem::canonical(inner).string());
  EXPECT_EQ(json["errors"][0]["line"], 3);
  EXPECT_EQ(json["errors"][0]["column"], 18);
  const Outcome text = check(folder / "world.wrl", false);
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.err, HasSubstr("inner.wrl:3:18: error: "));
  EXPECT_THAT(text.err, HasSubstr("Shape { geometry Bx {} }\n                 ^\n"));
}

TEST(Check, PackedWorldsAreTheSame) {
  const ScratchFolder folder;
  const std::string text = std::string(kHeader) + std::string(kFlawed);
  const Outcome run = check(folder.write("world.wrl.gz", gzipped(text)), true);
  EXPECT_EQ(run.exit_code, 0);
  Json json = run.json(), plain = json_of(folder, kFlawed);
  EXPECT_EQ(json["bytes"], text.size());
  for (const char* own : {"world", "read_ms", "defects_ms"}) json.erase(own), plain.erase(own);
  EXPECT_EQ(json, plain);
  // Places are those of the unpacked text.
  const Outcome bad = check(folder.write("bad.wrl.gz", gzipped(std::string(kHeader) + "\n\nGrop {}\n")), true);
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_EQ(Json::parse(bad.out)["errors"][0]["line"], 4);
}

TEST(Check, FilesThatCannotBeReadSayWhy) {
  const ScratchFolder folder;
  const auto missing = folder / "missing.wrl";
  const Outcome none = check(missing, true);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.err, missing.string() + ": error: there is no such file\n");
  const Json json = Json::parse(none.out);
  EXPECT_THAT(keys_of(json), kTopLevel);
  EXPECT_EQ(json["good"], false);
  EXPECT_EQ(
      json["errors"],
      (Json::array({{{"file", missing.string()}, {"line", 0}, {"column", 0}, {"message", "there is no such file"}}})));
  EXPECT_EQ(check(missing, false).exit_code, 2);
  EXPECT_EQ(check(folder.path(), true).exit_code, 3);  // a folder
  EXPECT_EQ(check(folder.path(), false).out, "");
}

TEST(Check, TextIsATableWithoutTheZeros) {
  const ScratchFolder folder;
  const Outcome flawed = check(folder, kFlawed, false);
  EXPECT_EQ(flawed.exit_code, 0);
  EXPECT_EQ(flawed.err, "");
  EXPECT_THAT(flawed.out,
              HasSubstr("  duplicate                            1  with the corners of an earlier one; first: "
                        "HULL/SKIN polygon 2\n"));
  EXPECT_THAT(flawed.out, Not(HasSubstr("routes")));
  EXPECT_THAT(flawed.out, Not(HasSubstr("no defects")));
  EXPECT_THAT(flawed.out, Not(HasSubstr("edges without length")));
  EXPECT_THAT(check(folder, "Shape { geometry Box {} }", false).out, HasSubstr("\nno defects of polygons\n"));
}

// Errors are shown although many warnings come first.
TEST(Check, TextShowsSomeProblemsAndJsonAll) {
  const ScratchFolder folder;
  std::string body;
  for (int i = 0; i < 120; ++i) body += "Transform { scale -1 1 1 }\n";
  for (int i = 0; i < 50; ++i) body += "Grop {}\n";
  const Outcome text = check(folder, body, false);
  EXPECT_EQ(text.exit_code, 1);
  const auto lines_with = [&](std::string_view what) {
    int lines = 0;
    for (std::size_t at = text.err.find(what); at != std::string::npos; at = text.err.find(what, at + 1)) ++lines;
    return lines;
  };
  EXPECT_EQ(lines_with(": warning: "), 20);
  EXPECT_EQ(lines_with(": error: "), 20);
  EXPECT_THAT(text.err, HasSubstr("world.wrl: note: 30 more errors, 100 more warnings; --json lists all\n"));
  EXPECT_THAT(text.err, testing::EndsWith("as browsers do, with warnings\n"));
  EXPECT_THAT(text.out, HasSubstr(": 50 errors, 120 warnings; "));
  const Json json = Json::parse(check(folder / "world.wrl", true).out);
  EXPECT_EQ(json["errors"].size(), 50U);
  EXPECT_EQ(json["warnings"].size(), 120U);
}

std::string shapes_of_36_million_polygons() {
  std::string body;
  for (int i = 0; i < 9; ++i) {
    body += "Shape { geometry Extrusion { crossSection [";
    for (int k = 0; k < 2001; ++k) body += std::to_string(k) + " 0,";
    body += "] spine [";
    for (int k = 0; k < 2001; ++k) body += "0 " + std::to_string(k) + " 0,";
    body += "] } }\n";
  }
  return body;
}

// Nothing is built for this answer: it would take tens of gigabytes.
TEST(Check, DefectsOfBillionsOfPolygonsAreNotLookedFor) {
  const ScratchFolder folder;
  const Outcome run = check(folder, "#\n" + shapes_of_36_million_polygons(), true, kExpansionMax);
  EXPECT_EQ(run.exit_code, 0);
  const Json json = run.json();
  EXPECT_GT(json["statistics"]["polygons"], 1 << 25);
  EXPECT_TRUE(json["defects"].is_null());
  EXPECT_THAT(json["unsupported"].dump(), HasSubstr("defects of more than 33554432 polygons"));
}

TEST(Check, InterestsInBillionsOfPolygonsAreNotLookedAt) {
  const ScratchFolder folder;
  const std::string body = "DEF A Group { children [ " + shapes_of_36_million_polygons() +
                           "] } DEF B Group { } CollisionInterest { objectPath \"A\" interests \"B\" }";
  const Json json = Json::parse(check(folder, body, true, kExpansionMax).out);
  EXPECT_TRUE(json["good"]);
  EXPECT_THAT(json["unsupported"].dump(), HasSubstr("interests in more than 33554432 polygons"));
}

// A million starts and stops are used up before that day is over, and the output says so.
TEST(Check, SensorsThatStopForWantOfTransitionsAreNamed) {
  const ScratchFolder folder;
  const std::string body =
      "DEF A TimeSensor { cycleInterval 0.01 loop TRUE } DEF B TimeSensor { cycleInterval 0.01 }\n"
      "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0 ] } DEF T Transform { }\n"
      "ROUTE A.cycleTime TO B.startTime ROUTE B.fraction_changed TO P.set_fraction\n"
      "ROUTE P.value_changed TO T.translation\n";
  const auto unsupported_at = [&](double at_s) {
    const auto world = folder.write("world.wrl", std::string(kHeader) + body);
    return check(world, {.json = true, .copy = {}, .at_s = at_s}).json()["unsupported"].dump();
  };
  EXPECT_EQ(unsupported_at(10), "[]");
  EXPECT_THAT(unsupported_at(86'400), HasSubstr("TimeSensors that start each other so often: they stand still from "));
}

TEST(Check, BytesThatAreNoUtf8DoNotBreakTheJson) {
  const ScratchFolder folder;
  const Outcome run = check(folder, "Shape { geometry B\xff {} }", true);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_FALSE(run.json()["errors"].empty());
}

TEST(Check, SaysWhereThingsHaveMovedByThen) {
  const ScratchFolder folder;
  const auto path =
      folder.write("lift.wrl",
                   "#VRML V2.0 utf8\nDEF LIFT Transform { }\nDEF T TimeSensor { cycleInterval 4 loop TRUE }\n"
                   "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 0 8 0 ] }\n"
                   "ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO LIFT.translation\n");
  const auto moving = only(check(path, {.json = true, .copy = {}, .at_s = 5.0}).json()["moving"]);
  EXPECT_EQ(moving["path"], "LIFT");
  EXPECT_NEAR(moving["position"][1].get<double>(), 2.0, 1e-9);
}

TEST(Check, WritesACopyThatNeedsNoOtherFile) {
  const ScratchFolder folder;
  folder.write("inner.wrl", "#VRML V2.0 utf8\nDEF BOX Shape { geometry Box { } }\n");
  const auto path = folder.write("outer.wrl", "#VRML V2.0 utf8\nInline { url \"inner.wrl\" }\n");
  const std::string copy = (folder / "copy.wrl").string();
  ASSERT_EQ(check(path, {.json = false, .copy = copy, .at_s = {}}).exit_code, 0);
  std::filesystem::remove(folder / "inner.wrl");
  EXPECT_EQ(check(copy, true).json()["statistics"]["polygons"], 6);
}

TEST(Check, ACopyThatCannotBeWrittenIsNotGood) {
  const ScratchFolder folder;
  const auto world = folder.write("w.wrl", "#VRML V2.0 utf8\nGroup { }\n");
  const Outcome text = check(world, {.json = false, .copy = "/dev/full", .at_s = {}});
  EXPECT_EQ(text.exit_code, 3);
  EXPECT_THAT(text.err, HasSubstr("/dev/full: error: can't be written: No space left on device"));
  EXPECT_EQ(text.out, "");
  const Outcome said = check(world, {.json = true, .copy = "/dev/full", .at_s = {}});
  EXPECT_EQ(said.exit_code, 3);
  EXPECT_EQ(said.json()["good"], false);
  EXPECT_EQ(said.json()["errors"][0]["file"], "/dev/full");
}

TEST(Check, SaysWhichMeshesAreClosedAndWhatBeginsInside) {
  const ScratchFolder folder;
  const std::string_view world = R"(
DEF ROOM Transform { children Shape { geometry Box { size 8 4 8 } } }
DEF BALL Transform { translation 1 0 0 children Shape { geometry Sphere { radius 0.5 } } }
DEF OPEN Transform { children Shape { geometry Cylinder { radius 20 height 20 top FALSE } } }
DEF OUTSIDE Transform { translation 6 0 0 children Shape { geometry Box { } } }
DEF ACROSS Transform { translation 4 0 0 children Shape { geometry Box { } } }
CollisionInterest { objectPath "BALL" interests [ "ROOM" "OPEN" "OUTSIDE" ] collisionType 1 }
CollisionInterest { objectPath "ROOM" interests [ "BALL" "ACROSS" "OUTSIDE" ] collisionType 2 }
)";
  const Json json = json_of(folder, world);
  EXPECT_EQ(json["closed"], Json::array({"ROOM", "BALL", "OUTSIDE", "ACROSS"}));
  EXPECT_EQ(json["inside"], Json::array({{{"inner", "BALL"}, {"outer", "ROOM"}}}));
  EXPECT_THAT(check(folder, world, false).out, HasSubstr("\nBALL begins inside ROOM\n"));
}

}  // namespace peerd::check_command_test
