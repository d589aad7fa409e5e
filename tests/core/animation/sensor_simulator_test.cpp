#include "core/animation/sensor_simulator.hpp"

#include <gmock/gmock.h>

#include "tests/core/animation/graph_fixture.hpp"

namespace peerd::animation::sensor_simulator_test {

// Sensor 0 runs from 1 s to 3 s; when it stops, its `time` starts sensor 1, which runs for 5 s.
Network chain() {
  return {{TimeSensorFields{2, true, false, 1, 0}, TimeSensorFields{5, true, false, -9, 0}},
          {{0, "cycleTime", 1, "set_startTime", FieldType::kTime}}};
}

TEST(SensorSimulator, KnowsTheInstantsOfALoneSensor) {
  GraphFixture g({{TimeSensorFields{4, true, false, 2, 0}}, {}});
  EXPECT_EQ(g.simulator.component_count(), 1u);
  EXPECT_EQ(g.simulator.next_instant(0, 0), 2.0);
  EXPECT_EQ(g.simulator.next_instant(0, 2), 6.0);
  EXPECT_EQ(g.simulator.next_instant(0, 6), kInfinity);
  EXPECT_EQ(g.simulator.previous_instant(0, 5), 2.0);
  EXPECT_EQ(g.simulator.previous_instant(0, 1), -kInfinity);
  EXPECT_TRUE(g.simulator.sensor(0, 2).active);
  EXPECT_FALSE(g.simulator.sensor(0, 6).active);
}

TEST(SensorSimulator, PutsSensorsThatAffectEachOtherIntoOneComponent) {
  GraphFixture joined(chain());
  EXPECT_EQ(joined.simulator.component_count(), 1u);
  EXPECT_THAT(joined.simulator.sensors(0), testing::UnorderedElementsAre(0u, 1u));
  Network apart = chain();
  apart.routes.clear();
  EXPECT_EQ(GraphFixture(apart).simulator.component_count(), 2u);
}

TEST(SensorSimulator, ListsChangesInOrderOfTime) {
  GraphFixture g(chain());
  std::vector<std::uint32_t> sensors;
  g.simulator.for_each_change(0, 0, 100, [&](bool is_port, std::uint32_t index) {
    if (!is_port) sensors.push_back(index);
  });
  ASSERT_FALSE(sensors.empty());
  EXPECT_EQ(sensors.front(), 0u);
  EXPECT_EQ(sensors.back(), 1u);
}

}  // namespace peerd::animation::sensor_simulator_test
