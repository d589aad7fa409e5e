#include "core/animation/event_graph.hpp"

#include <gmock/gmock.h>

#include "tests/core/animation/graph_fixture.hpp"

namespace peerd::animation::event_graph_test {

TEST(EventGraph, MarksThePortsThatASensorDrives) {
  const EventGraph graph(sensor_and_relay());
  EXPECT_TRUE(graph.ports[graph.find(2, "translation").value()].driven);
  EXPECT_FALSE(graph.ports[graph.find(4, "x").value()].driven);
  EXPECT_TRUE(graph.findings.empty());
}

TEST(EventGraph, MakesThePortsOfPlainNodesWhenTheyAreAskedFor) {
  EventGraph graph(sensor_and_relay());
  EXPECT_EQ(graph.find(2, "scale"), std::nullopt);
  const auto port = graph.find_or_add(2, "scale", FieldType::kVec3, true);
  ASSERT_TRUE(port);
  EXPECT_EQ(graph.find(2, "scale"), port);
  EXPECT_EQ(graph.find_or_add(2, "scale", FieldType::kVec3, true), port);
}

TEST(EventGraph, KnowsTheFieldsOfSensorsUnderAllTheirNames) {
  EventGraph graph(sensor_and_relay());
  const auto port = graph.find_or_add(0, "set_startTime", FieldType::kTime, true);
  ASSERT_TRUE(port);
  EXPECT_EQ(graph.find_or_add(0, "startTime", FieldType::kTime, true), port);
  EXPECT_EQ(graph.find_or_add(0, "startTime_changed", FieldType::kTime, false), port);
  EXPECT_EQ(graph.find_or_add(0, "noSuchField", FieldType::kTime, true), std::nullopt);
  EXPECT_EQ(graph.ports[*port].kind, PortKind::kSensorInput);
}

struct Case {
  const char* name;
  Route route;
  Problem problem;
};
class LeftOut : public testing::TestWithParam<Case> {};
TEST_P(LeftOut, IsFound) {
  Network network = sensor_and_relay();
  network.routes.push_back(GetParam().route);
  const EventGraph graph(network);
  ASSERT_EQ(graph.findings.size(), 1u);
  EXPECT_EQ(graph.findings[0].problem, GetParam().problem);
  EXPECT_EQ(graph.findings[0].index, 3u);
  EXPECT_EQ(graph.links[3].from, kNone);
}
INSTANTIATE_TEST_SUITE_P(
    Routes, LeftOut,
    testing::Values(
        Case{"NoSuchNode", {9, "x", 2, "translation", FieldType::kVec3}, Problem::kNoSuchNode},
        Case{"NoSuchField", {0, "height_changed", 2, "translation", FieldType::kFloat}, Problem::kNoSuchField},
        Case{"Type", {0, "fraction_changed", 2, "translation", FieldType::kFloat}, Problem::kTypeMismatch},
        Case{"Keys", {3, "k", 1, "set_key", FieldType::kFloats}, Problem::kRouteToKeys},
        Case{"Repeated", {3, "x", 4, "x", FieldType::kFloat}, Problem::kRepeated}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace peerd::animation::event_graph_test
