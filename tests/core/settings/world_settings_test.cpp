#include "core/settings/world_settings.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::world_settings_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\no a b\nf 1 2 3\no c1\nf 1 2 3\no c2\nf 1 2 3\n";
constexpr const char* kVrml =
    "#VRML V2.0 utf8\nDEF A Transform { children DEF S Shape { geometry DEF G Box { } } }\nDEF B Transform { children "
    "Shape { geometry USE G } }\n"
    "DEF T TimeSensor { }\nDEF P PositionInterpolator { }\nROUTE T.fraction_changed TO P.set_fraction\nROUTE "
    "P.value_changed TO B.translation\n";

ReadResult read_with(const std::string& name, const char* text, const WorldSettings& settings) {
  ReadOptions options;
  const auto side = std::make_shared<const std::string>("the side file\nline two\n");
  options.amend = amender_of(settings, {"side.toml", *side, side, TextKind::kLines}, options.limits);
  return formats::read_file(name, text, {}, options);
}

std::vector<std::string> paths(const Scene& scene, const InterestSide& side) {
  std::vector<std::string> out;
  for (const ObjectId id : side.ends) out.push_back(scene.path_of(id));
  return out;
}

TEST(WorldSettings, AllObjectsMeetAtTheFirstLevelThatHasSeveral) {
  WorldSettings settings;
  settings.collides_all = true;
  const ReadResult result = read_with("a.obj", kThree, settings);
  ASSERT_TRUE(result.scene);
  ASSERT_EQ(result.scene->interests.size(), 1U);
  EXPECT_THAT(paths(*result.scene, result.scene->interests[0].colliders), ElementsAre("\"a b\"", "c1", "c2"));
  EXPECT_EQ(result.sources.size(), 2U);  // the side file is a part of the world
  const ReadResult below = read_with("a.wrl",
                                     "#VRML V2.0 utf8\nDEF R Group { children Group { children [ DEF X Transform { "
                                     "children Shape { } } DEF Y Transform { } ] } }",
                                     settings);
  ASSERT_TRUE(below.scene);
  EXPECT_THAT(paths(*below.scene, below.scene->interests.at(0).colliders), ElementsAre("R/0/X", "R/0/Y"));
}

TEST(WorldSettings, InterestsNamePathsAndPatterns) {
  WorldSettings settings;
  settings.interests.push_back({"\"a b\"", {"c*"}, {"c2"}, CollisionType::kAllPairs, 3});
  const ReadResult result = read_with("a.obj", kThree, settings);
  ASSERT_TRUE(result.scene);
  EXPECT_THAT(paths(*result.scene, result.scene->interests.at(0).collidees), ElementsAre("c1"));
  EXPECT_EQ(result.scene->interests[0].type, CollisionType::kAllPairs);
  settings.interests[0].object = "d";
  const ReadResult wrong = read_with("a.obj", kThree, settings);
  EXPECT_EQ(formats::error_of(wrong), "no node of the scene is named 'd'");
  EXPECT_EQ(wrong.sources.at(wrong.diagnostics.at(0).source).name, "side.toml");
}

TEST(WorldSettings, ObjectsGetTheirFieldsInAnyFormat) {
  ObjectSetting object{.object = "B"};
  object.velocity_m_s = {1, 2, 3};
  object.owned_by_founder = true;
  object.response = CollisionResponse{.type = ResponseType::kImpulse, .mass_kg = 5.0, .restitution = 0.5};
  WorldSettings settings;
  settings.objects = {object};
  const ReadResult result = read_with("a.wrl", kVrml, settings);
  ASSERT_TRUE(result.scene);
  const Scene& scene = *result.scene;
  EXPECT_EQ(vrml::document_violation(*scene.document), "");
  const ObjectFields& fields = scene.object(scene.find("B").value());
  EXPECT_EQ(fields.velocity, Vec3(1, 2, 3));
  EXPECT_TRUE(fields.enslaved);
  EXPECT_EQ(fields.response, object.response);
  EXPECT_FALSE(scene.object(scene.find("A").value()).response);
  EXPECT_THAT(vrml::routes_of(*scene.document),
              ElementsAre("T.fraction_changed > P.set_fraction", "P.value_changed > B.translation"));
  settings.objects[0].object = "S";
  EXPECT_THAT(formats::error_of(read_with("a.wrl", kVrml, settings)), HasSubstr("is no Transform"));
  settings.objects[0].object = "none*";
  EXPECT_THAT(formats::error_of(read_with("a.wrl", kVrml, settings)), HasSubstr("named 'none*'"));
}

std::string many_transforms(int count) {
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < count; ++i) text += "DEF a" + std::to_string(i) + " Transform { }\n";
  return text;
}

// Looking through all names for each object would take minutes.
TEST(WorldSettings, ManyObjectsOfALargeWorldAreFound) {
  constexpr int kCount = 60'000;
  WorldSettings settings;
  for (int i = 0; i < kCount; ++i) {
    settings.objects.push_back({.object = "a" + std::to_string(i), .layers = static_cast<std::uint32_t>(i)});
  }
  const ReadResult result = read_with("a.wrl", many_transforms(kCount).c_str(), settings);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.scene->object(result.scene->find("a59999").value()).layers, 59'999U);
}

TEST(WorldSettings, OfPatternsThatFindANodeTheLastCountsAndOnlyThatIsKept) {
  const std::string world = many_transforms(1000);
  WorldSettings settings;
  std::string pattern = "a*";
  std::size_t bytes_of_one = 0;
  for (std::uint32_t i = 1; i <= 100; ++i, pattern += '*') {
    settings.objects.push_back({.object = pattern, .layers = i});
    if (i == 2) settings.objects.back().owned_by_founder = true;
    const ReadResult result = read_with("a.wrl", world.c_str(), settings);
    ASSERT_TRUE(result.scene);
    const Scene& scene = *result.scene;
    EXPECT_EQ(scene.object(scene.find("a7").value()).layers, i);
    EXPECT_EQ(scene.object(scene.find("a7").value()).enslaved, i >= 2);
    if (i == 2) bytes_of_one = scene.document->arena.size_bytes();
    if (i > 2) {
      EXPECT_EQ(scene.document->arena.size_bytes(), bytes_of_one);
    }
  }
}

TEST(WorldSettings, PatternsThatWouldVisitTooManyNodesAreRefused) {
  const std::string world = many_transforms(20'000);
  WorldSettings settings;
  for (int i = 0; i < 2000; ++i) settings.objects.push_back({.object = "b" + std::to_string(i) + "*"});
  EXPECT_THAT(formats::error_of(read_with("a.wrl", world.c_str(), settings)),
              HasSubstr("the patterns visit 40000000 nodes, more than 33554432; the option expansion allows more"));
  settings = {};
  settings.interests.push_back({.object = "a1", .with = std::vector<std::string>(2000, "b*")});
  EXPECT_THAT(formats::error_of(read_with("a.wrl", world.c_str(), settings)),
              HasSubstr("the patterns visit 40000000 nodes"));
}

}  // namespace
}  // namespace peerd::world_settings_test
