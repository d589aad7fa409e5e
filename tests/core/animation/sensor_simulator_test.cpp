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

TEST(SensorSimulator, LetsOneSensorStartAnother) {
  GraphFixture g(chain());
  EXPECT_FALSE(g.simulator.sensor(1, 0.9).active);
  EXPECT_TRUE(g.simulator.sensor(1, 1).active);
  EXPECT_EQ(g.simulator.sensor(1, 1).fields.start_time, 1.0);
  EXPECT_TRUE(g.simulator.sensor(1, 5.9).active);
  EXPECT_FALSE(g.simulator.sensor(1, 6).active);
  EXPECT_EQ(g.simulator.latest(g.port(1, "startTime"), 2)->value, 1.0);
}

TEST(SensorSimulator, AnswersThePastAgainAfterADelivery) {
  GraphFixture g(chain());
  const std::uint32_t start = g.port(1, "startTime");
  EXPECT_FALSE(g.simulator.sensor(1, 20).active);
  g.simulator.deliver(18, start, 18);
  EXPECT_TRUE(g.simulator.sensor(1, 20).active);
  EXPECT_FALSE(g.simulator.sensor(1, 17).active);
  EXPECT_EQ(g.simulator.latest(start, 17.5)->value, 1.0);
}

TEST(SensorSimulator, StandsStillOnceItsTransitionsAreUsedUp) {
  // Two sensors that start each other at the ends of their cycles.
  const Network ping_pong{
      {TimeSensorFields{1, true, false, 1, 0}, TimeSensorFields{1, true, false, -9, 0}},
      {{0, "time", 1, "set_startTime", FieldType::kTime}, {1, "time", 0, "set_startTime", FieldType::kTime}}};
  const EventGraph graph(ping_pong);
  SensorSimulator simulator(graph, ping_pong, 0.0, 100, 50);
  EXPECT_EQ(simulator.transition_limit_reached_at(), std::nullopt);
  static_cast<void>(simulator.sensor(0, 1e5));
  const auto stopped = simulator.transition_limit_reached_at();
  ASSERT_TRUE(stopped);
  EXPECT_LT(*stopped, 1e3);
  EXPECT_EQ(simulator.last_time(0), *stopped);
  EXPECT_EQ(simulator.next_instant(0, *stopped), kInfinity);
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
