#include "peerd/cli/commands/bake_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/cli/commands/collide_command.hpp"
#include "tests/peerd/cli/outcome.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::bake_command_test {

using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::outcome_of;
using testing_support::ScratchFolder;
using Json = nlohmann::ordered_json;

constexpr std::string_view kHeader = "#VRML V2.0 utf8\n";

Outcome collide(const std::filesystem::path& world) {
  return outcome_of([&](auto& out, auto& err) { return run_collide(world.string(), {.json = true}, out, err); });
}
Outcome bake(const std::filesystem::path& world) {
  return outcome_of([&](auto& out, auto& err) { return run_bake(world.string(), {.json = true}, out, err); });
}
std::filesystem::path write(const ScratchFolder& folder, std::string_view body) {
  return folder.write("world.wrl", std::string(kHeader) + std::string(body));
}

constexpr std::string_view kBaked = R"(
DEF A Shape { hierarchyFile "a.hierarchy" geometry Sphere {} }
DEF B Transform { translation 1.5 0 0 children Shape { geometry Box {} } }
CollisionInterest { objectPath "A" interests "B" collisionType 2 })";

TEST(Bake, CollideUsesTheFileAndGivesTheSameAnswer) {
  const ScratchFolder folder;
  const auto world = write(folder, kBaked);
  const Json built = collide(world).json();
  EXPECT_EQ(built["counters"]["hierarchies_built"], 2);
  const Outcome baked = bake(world);
  EXPECT_EQ(baked.exit_code, 0) << baked.err;
  EXPECT_EQ(baked.json()["files"].size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "a.hierarchy"));
  const Outcome read = collide(world);
  EXPECT_EQ(read.err, "");
  EXPECT_EQ(read.json()["interests"], built["interests"]);
  EXPECT_EQ(read.json()["counters"]["hierarchies_built"], 1);
  EXPECT_EQ(bake(world).exit_code, 0);  // again, over its own file
}

TEST(Bake, AFileThatDoesNotFitIsSaidAndNotUsed) {
  const ScratchFolder folder;
  const auto world = write(folder, kBaked);
  const Json expected = collide(world).json();
  ASSERT_EQ(bake(world).exit_code, 0);
  const auto file = folder.path() / "a.hierarchy";
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const auto note_for = [&](const std::string& content) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
    const Outcome outcome = collide(world);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.json()["interests"], expected["interests"]);
    return outcome.err;
  };
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  EXPECT_THAT(note_for(damaged), HasSubstr("A: hierarchyFile \"a.hierarchy\" is not used: it is damaged"));
  EXPECT_THAT(note_for(bytes.substr(0, bytes.size() - 1)), HasSubstr("cut short"));
  EXPECT_THAT(note_for(""), HasSubstr("it is empty"));
  EXPECT_THAT(note_for("no hierarchy at all"), HasSubstr("it is no hierarchy file"));
  for (const int version : {3, 5}) {  // the one before, and one to come
    std::string other = bytes;
    other[8] = static_cast<char>(version);
    EXPECT_THAT(note_for(other), HasSubstr("another version")) << version;
  }
  write(folder, std::string(kBaked).replace(kBaked.find("Sphere {}"), 9, "Sphere { radius 1.1 }"));
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  EXPECT_THAT(collide(world).err, HasSubstr("it is of another mesh"));
}

TEST(Bake, WritesNowhereElseAndOverNothingElse) {
  const ScratchFolder folder;
  const auto said = [&](std::string_view url) {
    const Outcome outcome =
        bake(write(folder, "Shape { hierarchyFile \"" + std::string(url) + "\" geometry Sphere {} }"));
    EXPECT_EQ(outcome.exit_code, 3);
    return outcome.err;
  };
  EXPECT_THAT(said("../a.hierarchy"), HasSubstr("it is not in the folder of the world"));
  EXPECT_THAT(said("/tmp/a.hierarchy"), HasSubstr("it is not in the folder of the world"));
  EXPECT_THAT(said("b/../../a.hierarchy"), HasSubstr("it is not in the folder of the world"));
  EXPECT_THAT(said("http://a/b"), HasSubstr("it is no file of this machine"));
  EXPECT_THAT(said("world.wrl"), HasSubstr("there is another file of that name"));
}

TEST(Bake, OneFileHoldsOneHierarchy) {
  const ScratchFolder folder;
  const Outcome outcome = bake(write(folder, R"(
    Shape { hierarchyFile "a.hierarchy" geometry Sphere {} }
    DEF B Shape { hierarchyFile "a.hierarchy" geometry Box {} })"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("B: hierarchyFile \"a.hierarchy\" is another Shape's too"));
}

}  // namespace peerd::bake_command_test
