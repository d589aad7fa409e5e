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

}  // namespace peerd::animation::event_graph_test
