#include "core/motion/moving_scene.hpp"

#include <gmock/gmock.h>

#include <map>

#include "tests/core/read_text.hpp"

namespace peerd::moving_scene_test {

using testing::ElementsAre;
using testing::IsEmpty;

// The world moves up 2 m in 2 s and down again, for ever.
const std::string kClock = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 0, 0 2 0, 0 0 0 ] }
ROUTE T.fraction_changed TO P.set_fraction
)";

TEST(MovingScene, UpdatesWhatMovesAndNothingElse) {
  std::string body = "DEF LIFT Transform { children Shape { geometry Box { } } }" + kClock +
                     "ROUTE P.value_changed TO LIFT.translation\n";
  for (int i = 0; i < 1000; ++i) body += "Transform { translation " + std::to_string(i) + " 0 0 children Shape { } }\n";
  const Scene scene = scene_of(body);
  MovingScene world(scene);
  (void)world.go_to(0.0);
  const auto before = world.graph().counters();
  for (int i = 1; i <= 100; ++i) {
    EXPECT_EQ(world.go_to(0.01 * i).size(), 2u) << "LIFT and its Shape";
    EXPECT_EQ(world.world_from_local({0}).offset, world.world_from_local({1}).offset);
  }
  EXPECT_EQ(world.graph().counters().poses_updated - before.poses_updated, 100u);
  EXPECT_TRUE(world.world_from_local({1}).offset.isApprox(Vec3(0, 1, 0)));
  (void)world.go_to(0.5);
  EXPECT_TRUE(world.world_from_local({1}).offset.isApprox(Vec3(0, 0.5, 0))) << "backwards too";
  EXPECT_EQ(world.graph().counters().boxes_updated, 0u);
  EXPECT_EQ(world.meshes_built(), 0u) << "nobody asked for a box";
}

TEST(MovingScene, AgreesWithTheScene) {
  const Scene scene = scene_of(
      "DEF A Transform { translation 1 2 3 rotation 1 1 0 0.7 scale 2 1 3 center 1 0 0 children DEF B Transform { "
      "rotation 0 1 0 2 } }");
  MovingScene world(scene);
  (void)world.go_to(3.0);
  for (const std::uint32_t i : {0u, 1u}) {
    EXPECT_EQ(world.world_from_local({i}).offset, Vec3(scene.world_from_local({i}).translation()));
    EXPECT_EQ(world.world_from_local({i}).linear, Mat3(scene.world_from_local({i}).linear()));
  }
}

TEST(MovingScene, BoxesHoldWhatIsBelowAndAreMadeWhenAskedFor) {
  const Scene scene = scene_of(
      "DEF LIFT Transform { children [ DEF S Shape { geometry DEF BOX Box { size 2 4 6 } } Transform { translation 10 "
      "0 0 children Shape { geometry USE BOX } } ] }"
      "Shape { geometry Sphere { } }" +
      kClock + "ROUTE P.value_changed TO LIFT.translation");
  MovingScene world(scene);
  (void)world.go_to(1.0);
  const WorldBox box = world.box(scene.find("LIFT").value());
  EXPECT_EQ(world.meshes_built(), 1u) << "one Box, used twice; the Sphere is not below";
  EXPECT_LE((box.lo - Vec3(-1, -1, -3)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((box.hi - Vec3(11, 3, 3)).cwiseAbs().maxCoeff(), 1e-12);
  (void)world.go_to(2.0);
  EXPECT_LE((world.box(scene.find("LIFT").value()).hi - Vec3(11, 4, 3)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(world.meshes_built(), 1u);
  EXPECT_TRUE(world.box(scene.find("S").value()).contains(Vec3(1, 4, 3)));
}

// ---- Inlines that are read when they are near ----

FileLoader files(std::map<std::string, std::string> texts) {
  return [texts](std::string_view url, std::string_view) -> std::expected<LoadedFile, std::string> {
    const auto it = texts.find(std::string(url));
    if (it == texts.end()) return std::unexpected("there is no such file");
    return LoadedFile{it->first, world_text(it->second)};
  };
}

constexpr const char* kTwoHouses = R"(
  DEF NEAR Transform { translation 10 0 0 children DEF HOUSE Inline { url "house.wrl" bboxSize 4 4 4 } }
  DEF FAR Transform { translation 1000 0 0 children Inline { url "house.wrl" bboxSize 4 4 4 } }
  DEF CAR Transform { children Shape { geometry Box { } } }
)";

TEST(MovingSceneInlines, AreFilledWhereTheyAreOfInterest) {
  ReadOptions options;
  options.load = files({{"house.wrl", "DEF DOOR Transform { children Shape { geometry Box { } } }" + kClock +
                                          "ROUTE P.value_changed TO DOOR.translation"}});
  options.defer_inlines = true;
  const std::string text = world_text(kTwoHouses);
  const ReadResult read = read_world(text, options);
  ASSERT_TRUE(read.scene.has_value());
  const Scene& scene = *read.scene;
  ASSERT_EQ(scene.pending_inlines.size(), 2u);
  EXPECT_EQ(read.sources.size(), 1u) << "house.wrl has not been opened";
  EXPECT_EQ(scene.instances.size(), 6u);
  MovingScene world(scene);
  (void)world.go_to(1.0);
  const WorldBox here{Vec3(0, -5, -5), Vec3(9, 5, 5)};
  ASSERT_EQ(world.inlines_near(here), std::vector<std::size_t>{0});
  const ReadResult house = read_inline(scene.pending_inlines[0], options);
  ASSERT_TRUE(house.scene.has_value());
  world.fill_inline(0, std::make_shared<const Scene>(*house.scene));
  EXPECT_TRUE(world.inlines_near(here).empty());
  const ObjectId near_house = scene.find("HOUSE").value();
  const NodeHandle door = world.graph().first_child(world.node(near_house));
  ASSERT_TRUE(world.graph().alive(door));
  EXPECT_TRUE(world.graph().world_from_local(door).offset.isApprox(Vec3(10, 1, 0))) << "1 m up after 1 s";
  EXPECT_EQ(world.go_to(2.0).size(), 2u);
  EXPECT_TRUE(world.graph().world_from_local(door).offset.isApprox(Vec3(10, 2, 0)));
  EXPECT_TRUE(world.box(near_house).contains(Vec3(11, 3, 1)));
}

// A CollisionInterest needs what is within its objects, and every peer the same: those Inlines are read at once.
TEST(MovingSceneInlines, AreReadAtOnceWhereTheyCollide) {
  ReadOptions options;
  options.load = files({{"house.wrl", "Shape { geometry Box { } } Inline { url \"shed.wrl\" bboxSize 1 1 1 }"},
                        {"shed.wrl", "Shape { }"}});
  options.defer_inlines = true;
  const std::string text =
      world_text(kTwoHouses + std::string("CollisionInterest { objectPath \"CAR\" interests \"NEAR\" }"));
  const ReadResult read = read_world(text, options);
  ASSERT_TRUE(read.scene.has_value());
  EXPECT_EQ(read.scene->pending_inlines.size(), 1u) << "only the far one";
  EXPECT_EQ(read.sources.size(), 3u);
  EXPECT_EQ(read.scene->instances.size(), 9u) << "the house, and the shed in it";
}

TEST(MovingSceneInlines, SayWhatCannotBeRead) {
  ReadOptions options;
  options.load = files({{"bad.wrl", "Shpae { }"}});
  const ReadResult none = read_inline({{0}, {}, {}, {"none.wrl", "gone.wrl"}, "world.wrl"}, options);
  EXPECT_FALSE(none.scene.has_value());
  ASSERT_EQ(none.diagnostics.size(), 1u);
  EXPECT_EQ(none.diagnostics[0].message,
            "this Inline cannot be read: 'none.wrl': there is no such file; 'gone.wrl': there is no such file");
  const ReadResult bad = read_inline({{0}, {}, {}, {"none.wrl", "bad.wrl"}, "world.wrl"}, options);
  EXPECT_FALSE(bad.scene.has_value());
  EXPECT_EQ(render(bad, bad.diagnostics.at(0)).substr(0, 19), "bad.wrl:2:1: error:");
}

}  // namespace peerd::moving_scene_test
