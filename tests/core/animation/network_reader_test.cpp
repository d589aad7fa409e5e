#include "core/animation/network_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::network_reader_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kMover =
    "DEF T TimeSensor { cycleInterval 4 loop TRUE startTime 1e9 }\n"
    "DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0 1 2 3 ] }\n"
    "DEF X Transform { }\n"
    "ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO X.set_translation\n";

TEST(ReadNetwork, TakesSensorsInterpolatorsAndRoutes) {
  const Scene scene = scene_of(kMover);
  const NetworkReadResult read = read_network(scene.document);
  EXPECT_TRUE(read.has_sensors);
  ASSERT_EQ(read.network.nodes.size(), 3u);
  ASSERT_EQ(read.network.routes.size(), 2u);
  EXPECT_EQ(read.routes_at.size(), 2u);
  std::vector<std::string_view> types;
  for (const std::uint32_t node : read.document_node) types.push_back(scene.document->nodes[node].type->name);
  EXPECT_THAT(types, testing::UnorderedElementsAre("TimeSensor", "PositionInterpolator", "Transform"));
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i] != "TimeSensor") continue;
    const auto& sensor = std::get<animation::TimeSensorFields>(read.network.nodes[i]);
    EXPECT_EQ(sensor, (animation::TimeSensorFields{4, true, true, 1e9, 0}));
  }
}

TEST(ReadNetwork, LeavesOutNodesWithoutARoute) {
  const Scene scene = scene_of("Group { } TimeSensor { loop TRUE }");
  const NetworkReadResult read = read_network(scene.document);
  EXPECT_FALSE(read.has_sensors);
  EXPECT_THAT(read.network.routes, IsEmpty());
}

TEST(CheckNetwork, SaysNothingOfAGoodNetwork) { EXPECT_THAT(problems_of(kMover), IsEmpty()); }

TEST(CheckNetwork, ReportsKeysOutOfOrder) {
  std::string world = kMover;
  world.replace(world.find("[ 0 1 ]"), 7, "[ 1 0 ]");
  const auto problems = problems_of(world);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0], HasSubstr("warning 3:"));
}

}  // namespace peerd::vrml::network_reader_test
