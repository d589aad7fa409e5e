#include <gmock/gmock.h>

#include "peerd/input/world_file.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::side_file_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

constexpr const char* kObj =
    "v 0 0 0\nv 1000 0 0\nv 0 0 1000\no left arm\nf 1 2 3\no crate1\nf 1 2 3\no crate2\nf 1 2 3\n";

TEST(SideFile, SaysUnitsAxesInterestsAndObjects) {
  const auto settings = must(read_side_file(
      "unit = \"mm\"\nup = \"z\"\n[[interest]]\nobject = \"a\"\nwith = [\"b*\"]\ntype = \"box\"\n"
      "[object.\"left arm\"]\nresponse = \"impulse\"\nmass_kg = 2\nowned_by_founder = true\nlayers = 5\n",
      "s"));
  EXPECT_EQ(settings.conversion, (Conversion{0.001, true}));
  EXPECT_EQ(settings.interests.at(0).type, CollisionType::kBox);
  EXPECT_EQ(settings.objects.at(0).object, "left arm");
  EXPECT_EQ(settings.objects[0].response->mass_kg, 2.0);
  EXPECT_EQ(settings.objects[0].layers, 5U);
}

TEST(SideFile, TheLastSettingOfAnObjectCounts) {
  const ScratchFolder folder;
  const auto path = folder.write("w.obj", kObj);
  const auto layers = [&](const char* text) {
    folder.write("w.peerd.toml", text);
    const auto world = must(read_world_file(path));
    const Scene& scene = *world->result.scene;
    return std::pair(scene.object(scene.find("crate1").value()).layers,
                     scene.object(scene.find("crate2").value()).layers);
  };
  EXPECT_EQ(layers("[object.\"crate*\"]\nlayers = 3\n[object.crate1]\nlayers = 5\n"), std::pair(5U, 3U));
  EXPECT_EQ(layers("[object.crate1]\nlayers = 5\n[object.\"crate*\"]\nlayers = 3\n"), std::pair(3U, 3U));
  EXPECT_EQ(layers("[object.crate2]\nlayers = 5\n[object.\"*\"]\nlayers = 3\n"), std::pair(3U, 3U));
}

TEST(SideFile, WrongKeysAreErrorsAtTheirPlaces) {
  EXPECT_THAT(error_of(read_side_file("unit = \"mile\"\n", "s")).text, HasSubstr("s:1:"));
  EXPECT_THAT(error_of(read_side_file("units = \"mm\"\n", "s")).text, HasSubstr("did you mean"));
  EXPECT_THAT(error_of(read_side_file("[object.a]\nmass_kg = 2\nresponse = \"stop\"\n", "s")).text,
              HasSubstr("impulse"));
  EXPECT_THAT(error_of(read_side_file("[[interest]]\nobject = \"a\"\n", "s")).text, HasSubstr("with"));
}

TEST(SideFile, StandsBesideAWorldAndIsPartOfIt) {
  const ScratchFolder folder;
  const auto path = folder.write("w.obj", kObj);
  const auto alone = must(read_world_file(path));
  ASSERT_TRUE(alone->result.scene);
  EXPECT_TRUE(alone->result.scene->interests.empty());
  folder.write("w.peerd.toml", "unit = \"mm\"\nup = \"z\"\ncollide = [\"\\\"left arm\\\"\", \"crate*\"]\n");
  const auto with_side = must(read_world_file(path));
  ASSERT_TRUE(with_side->result.scene);
  const Scene& scene = *with_side->result.scene;
  EXPECT_EQ(scene.interests.size(), 2U);
  const auto& points = std::get<FaceSetGeometry>(scene.geometries.at(0)).points;
  EXPECT_EQ(points[1], Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(points[2], Eigen::Vector3f(0, 1, 0));
  EXPECT_NE(content_hash(alone->result), content_hash(with_side->result));
  // Read from its archive it is the same world, whatever its name.
  const auto elsewhere = must(read_world_bytes(pack(archive_of(*with_side)), "there", {}));
  ASSERT_TRUE(elsewhere->result.scene);
  EXPECT_EQ(content_hash(elsewhere->result), content_hash(with_side->result));
  EXPECT_EQ(elsewhere->result.scene->interests.size(), 2U);
  // Options count before the side file, and go with the archive, too.
  const auto asked = must(read_world_file(path, {.collide = "none", .unit = "m"}));
  EXPECT_TRUE(asked->result.scene->interests.empty());
  const auto asked_elsewhere = must(read_world_bytes(pack(archive_of(*asked)), "there", {}));
  EXPECT_EQ(content_hash(asked_elsewhere->result), content_hash(asked->result));
}

TEST(SideFile, ListsOfWhatCollidesAreShort) {
  const auto listing = [](int count, const std::string& name) {
    std::string text = "collide = [";
    for (int i = 0; i < count; ++i) text += "\"" + name + std::to_string(i) + "\",";
    return text + "]\n";
  };
  EXPECT_EQ(must(read_side_file(listing(256, "a"), "s")).interests.size(), 256U);
  const std::string why = "s:1:11: error: collide lists at most 256 paths and patterns, of 64 KiB together";
  EXPECT_THAT(error_of(read_side_file(listing(257, "a"), "s")).text, HasSubstr(why));
  EXPECT_THAT(error_of(read_side_file(listing(20, std::string(4000, 'a')), "s")).text, HasSubstr(why));
}

// A search for each line from the begin of the text would take minutes.
TEST(SideFile, ManyObjectsBehindManyLinesHaveTheirPlaces) {
  constexpr std::size_t kLines = 1'000'000, kObjects = 40'000;
  std::string text(kLines, '\n');
  const std::size_t begin = text.size();
  for (std::size_t i = 0; i < kObjects; ++i) text += "[object.a" + std::to_string(10'000 + i) + "]\n";
  const auto settings = must(read_side_file(text, "s"));
  ASSERT_EQ(settings.objects.size(), kObjects);
  const std::size_t length = std::string("[object.a10000]\n").size();
  for (const std::size_t i : {std::size_t{0}, kObjects / 2, kObjects - 1}) {
    EXPECT_EQ(settings.objects[i].offset, begin + i * length) << settings.objects[i].object;
  }
}

TEST(SideFile, OptionsAreCutOutsideOfQuotesAndBlanks) {
  const ScratchFolder folder;
  const auto path = folder.write("w.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\no a, b\nf 1 2 3\no c\nf 1 2 3\no d\nf 1 2 3\n");
  const auto world = must(read_world_file(path, {.collide = " \"a, b\" , c,d "}));
  ASSERT_TRUE(world->result.scene);
  EXPECT_EQ(world->result.scene->interests.size(), 3U);
}

TEST(SideFile, TheWholeNameOfAWorldComesFirst) {
  const ScratchFolder folder;
  const auto obj = folder.write("hall.obj", kObj), vrml = folder.write("hall.wrl", "#VRML V2.0 utf8\nShape { }\n");
  folder.write("hall.obj.peerd.toml", "unit = \"mm\"\n");
  EXPECT_TRUE(must(read_world_file(obj))->has_unit);
  EXPECT_TRUE(must(read_world_file(vrml))->result.scene);
  // A short name that two worlds have in common would be of one that is not meant.
  folder.write("hall.peerd.toml", "up = \"z\"\n");
  EXPECT_FALSE(must(read_world_file(obj))->has_up);
  EXPECT_THAT(error_of(read_world_file(vrml)).text, HasSubstr("unit and up say nothing of it")) << "no other has it";
  std::filesystem::remove(folder / "hall.obj.peerd.toml");
  EXPECT_EQ(error_of(read_world_file(vrml)).text,
            (folder / "hall.peerd.toml").string() +
                ": error: it may be of hall.wrl or of hall.obj; call it hall.wrl.peerd.toml to have it for hall.wrl");
  std::filesystem::remove(folder / "hall.obj");
  std::filesystem::rename(folder / "hall.wrl", folder / "hall.wrl.gz");
  EXPECT_THAT(error_of(read_world_file(folder / "hall.wrl.gz")).text, HasSubstr("unit and up say nothing of it"));
  const auto plain = folder.write("hall", kObj);  // whose long name is the short one of others
  EXPECT_TRUE(must(read_world_file(plain))->has_up);
  const auto long_name = folder.write(std::string(245, 'a') + ".wrl", "#VRML V2.0 utf8\nShape { }\n");
  EXPECT_TRUE(must(read_world_file(long_name))->result.scene) << "no side file can have that name";
}

TEST(SideFile, ThatCannotBeAskedForIsAnError) {
  const ScratchFolder folder;
  const auto path = folder.write("w.obj", kObj);
  std::filesystem::create_symlink("w.peerd.toml", folder / "w.peerd.toml");  // to itself
  EXPECT_THAT(error_of(read_world_file(path)).text,
              testing::ContainsRegex("w.peerd.toml: error: can't be read: .*link"));
  std::filesystem::remove(folder / "w.peerd.toml");
  std::filesystem::create_symlink("gone", folder / "w.peerd.toml");
  EXPECT_THAT(error_of(read_world_file(path)).text, HasSubstr("w.peerd.toml: error: "));
  std::filesystem::remove(folder / "w.peerd.toml");
  std::filesystem::create_directories(folder / "w.peerd.toml");
  EXPECT_THAT(error_of(read_world_file(path)).text, HasSubstr("w.peerd.toml: error: it is no regular file"));
}

TEST(SideFile, OfAVrmlWorldHasNoUnit) {
  const ScratchFolder folder;
  const auto path =
      folder.write("w.wrl", "#VRML V2.0 utf8\nDEF A Transform { children Shape { } }\nDEF B Transform { }\n");
  EXPECT_EQ(must(read_world_file(path, {.collide = "A,B"}))->result.scene->interests.size(), 2U);
  EXPECT_THAT(error_of(read_world_file(path, {.unit = "mm"})).text, HasSubstr("says its unit"));
}

TEST(SideFile, BuffersImagesAndMaterialsGoWithAWorld) {
  const ScratchFolder folder;
  folder.write("m.mtl", "newmtl a\nmap_Kd a.png\n");
  folder.write("a.png", "\x89PNG");
  const auto path = folder.write("w.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  const auto here = must(read_world_file(path));
  EXPECT_EQ(here->result.sources.size(), 3U);
  const auto there = must(read_world_bytes(pack(archive_of(*here)), "nowhere/else", {}));
  ASSERT_TRUE(there->result.scene);
  EXPECT_TRUE(there->result.diagnostics.empty());
  EXPECT_EQ(content_hash(there->result), content_hash(here->result));
}

}  // namespace peerd::side_file_test
