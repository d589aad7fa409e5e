#include "peerd/cli/commands/export_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/peerd/cli/outcome.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/peerd/view/picture/glb_reader.hpp"

namespace peerd::export_command_test {

using nlohmann::json;
using peerd::testing_support::Glb;
using peerd::testing_support::Outcome;
using peerd::testing_support::read_glb;
using peerd::testing_support::ScratchFolder;
using peerd::testing_support::text_of;
using testing::ElementsAre;
using testing::HasSubstr;

Outcome export_world(const std::filesystem::path& world, const std::filesystem::path& file, double at_s = 0.0,
                     bool as_json = true) {
  return peerd::testing_support::outcome_of([&](auto& out, auto& err) {
    return run_export(world.string(), {.json = as_json, .gltf = file.string(), .at_s = at_s}, out, err);
  });
}

TEST(Export, AllWorldsThatWeShipAreGoodFiles) {
  const ScratchFolder folder;
  int worlds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(PEERD_SOURCE_DIR) + "/configs/worlds")) {
    if (entry.path().extension() != ".wrl") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const Outcome outcome = export_world(entry.path(), folder / "w.glb", 2.5);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string bytes = text_of(folder / "w.glb");
    const Glb glb = read_glb(bytes);
    EXPECT_THAT(glb.problems, ElementsAre());
    const json said = outcome.json();
    EXPECT_EQ(said.at("bytes"), bytes.size());
    EXPECT_EQ(said.at("undrawn").size(), glb.extras().at("undrawn").size());
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < said.at("nodes").get<std::size_t>(); ++i) {
      triangles += glb.triangles(static_cast<int>(i)).size();
    }
    EXPECT_EQ(said.at("triangles"), triangles);
    ++worlds;
  }
  EXPECT_GE(worlds, 13);
}

TEST(Export, TheInstantSaysWhereTheWorldHasMovedThings) {
  const ScratchFolder folder;
  const auto world = folder.write(
      "w.wrl", "#VRML V2.0 utf8\nDEF D Transform { velocityVector 2 0 0 children Shape { geometry Box { } } }\n");
  for (const double at_s : {0.0, 3.0}) {
    ASSERT_EQ(export_world(world, folder / "w.glb", at_s).exit_code, 0);
    const Glb glb = read_glb(text_of(folder / "w.glb"));
    EXPECT_EQ(glb.nodes.at(0).world.translation(), Vec3(2.0 * at_s, 0, 0));
  }
}

TEST(Export, EmbedsImagesThatLieBesideTheWorld) {
  const ScratchFolder folder;
  folder.write("a.png", std::string_view("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\2\0\0\0\0\0\0\0", 33));
  folder.write("no.png", "no image");
  const auto world = folder.write("w.wrl", R"(#VRML V2.0 utf8
DEF A Shape { appearance Appearance { texture ImageTexture { url "a.png" } } geometry Box { } }
DEF B Shape { appearance Appearance { texture ImageTexture { url "no.png" } } geometry Box { } }
DEF C Shape { appearance Appearance { texture ImageTexture { url "http://example.org/c.png" } } geometry Box { } }
)");
  const Outcome outcome = export_world(world, folder / "w.glb");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Glb glb = read_glb(text_of(folder / "w.glb"));
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_EQ(glb.json.at("images").size(), 1u);
  const json undrawn = outcome.json().at("undrawn");
  ASSERT_EQ(undrawn.size(), 2u);
  EXPECT_EQ(undrawn.at(0).at("why"), "ImageTexture: \"no.png\": it is neither PNG nor JPEG");
  EXPECT_EQ(undrawn.at(1).at("why"), "ImageTexture: \"http://example.org/c.png\": it is no file of this machine");
}

TEST(Export, SaysWhatItLeavesOut) {
  const ScratchFolder folder;
  const auto world = folder.write("w.wrl", "#VRML V2.0 utf8\nDEF S Shape { geometry Text { string \"a\" } }\n");
  const Outcome outcome = export_world(world, folder / "w.glb", 0.0, /*as_json=*/false);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("1 Shape of 0 meshes, 0 triangles; 0 nodes move by themselves\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  S (Text): other programs do not draw it\n"));
}

TEST(Export, SaysWhatOtherProgramsShowOtherwise) {
  const ScratchFolder folder;
  const auto world = folder.write("w.wrl", R"(#VRML V2.0 utf8
DEF L LOD { range [ 5 ] level [ Shape { geometry Box { } } Shape { geometry Sphere { } } ] }
DEF B Billboard { children Shape { geometry Box { } } }
DEF A Anchor { url "#V" children Shape { geometry Box { } } })");
  const Outcome outcome = export_world(world, folder / "w.glb", 0.0, /*as_json=*/false);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("  L (LOD): its first level, which collides, stands for all\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  B (Billboard): other programs do not turn it\n"));
  EXPECT_THAT(outcome.out, HasSubstr("  A (Anchor): other programs do not follow it\n"));
}

// glTF has no words for levels, and what is in the file is what collides.
TEST(Export, HasTheFirstLevelOfAnLod) {
  const ScratchFolder folder;
  const auto world = folder.write("w.wrl", R"(#VRML V2.0 utf8
LOD { range [ 20 ] level [
  Group { children [ Shape { geometry Box { } } LOD { level [ Shape { geometry Cone { } } Shape { geometry Sphere { } } ] } ] }
  Shape { geometry Sphere { } } ] })");
  const Outcome outcome = export_world(world, folder / "w.glb");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.json()["shapes"], 2);
  EXPECT_EQ(outcome.json()["meshes"], 2);
  EXPECT_EQ(outcome.json()["triangles"], 12 + 46) << "a Box and a Cone";
  EXPECT_EQ(outcome.json()["undrawn"][0]["what"], "LOD");
  EXPECT_EQ(outcome.json()["undrawn"].size(), 2u);
}

TEST(Export, EndsWithACode) {
  const ScratchFolder folder;
  const auto bad = folder.write("bad.wrl", "#VRML V2.0 utf8\nShape { geometry Bax { } }\n");
  const auto good = folder.write("good.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  EXPECT_EQ(export_world(bad, folder / "w.glb").exit_code, 1);
  EXPECT_EQ(export_world(folder / "none.wrl", folder / "w.glb").exit_code, 2);
  EXPECT_EQ(export_world(good, folder / "no/such/folder/w.glb").exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "w.glb"));
}

}  // namespace peerd::export_command_test
