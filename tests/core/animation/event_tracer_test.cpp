#include "core/animation/event_tracer.hpp"

#include <gmock/gmock.h>

#include "tests/core/animation/graph_fixture.hpp"

namespace peerd::animation::event_tracer_test {

using testing::ElementsAre;

struct Traced : GraphFixture {
  explicit Traced(const Network& network = sensor_and_relay())
      : GraphFixture(network), tracer(graph, simulator, deliveries) {
    tracer.grow(graph.ports.size());
  }
  EventTracer tracer;
};

TEST(EventTracer, FollowsThePathBackToTheSensor) {
  Traced t;
  const std::uint32_t target = t.port(2, "translation");
  EXPECT_FALSE(t.tracer.find(target, 1.9, EventTracer::At::kNow));  // nothing has been sent
  ASSERT_TRUE(t.tracer.find(target, 3, EventTracer::At::kNow));
  EXPECT_EQ(t.tracer.source().port, t.port(0, "fraction_changed"));
  EXPECT_EQ(t.tracer.source().stamp.t, 3.0);
  EXPECT_THAT(t.tracer.path(), ElementsAre(target, t.port(1, "value_changed"), t.port(0, "fraction_changed")));
  Value value;
  t.tracer.evaluate(3, value);
  EXPECT_EQ(value.vec3(), Vec3(2, 0, 0));
}

TEST(EventTracer, KeepsTheFinalEventOfASensorThatStopped) {
  Traced t;
  ASSERT_TRUE(t.tracer.find(t.port(2, "translation"), 100, EventTracer::At::kNow));
  EXPECT_EQ(t.tracer.source().stamp.t, 6.0);
  Value value;
  t.tracer.evaluate(100, value);
  EXPECT_EQ(value.vec3(), Vec3(8, 0, 0));
}

TEST(EventTracer, TakesTheLaterOfADeliveryAndASensor) {
  Traced t;
  const std::uint32_t target = t.port(2, "translation");
  t.deliveries.insert(target, 4, Value::of_vec3({0, 7, 0}));
  Value value;
  ASSERT_TRUE(t.tracer.find(target, 5, EventTracer::At::kNow));
  t.tracer.evaluate(5, value);
  EXPECT_EQ(value.vec3(), Vec3(6, 0, 0));  // the sensor sends all the time
  ASSERT_TRUE(t.tracer.find(target, 4, EventTracer::At::kNow));
  t.tracer.evaluate(4, value);
  EXPECT_EQ(value.vec3(), Vec3(0, 7, 0));  // at one time the one that came over fewer ROUTEs
}

TEST(EventTracer, LooksJustBehindATime) {
  Traced t;
  ASSERT_TRUE(t.tracer.find(t.port(2, "translation"), 3, EventTracer::At::kJustAfter));
  EXPECT_EQ(t.tracer.source().stamp.t, kInfinity);  // an active sensor sends without end
  ASSERT_TRUE(t.tracer.find(t.port(2, "translation"), 6, EventTracer::At::kJustAfter));
  EXPECT_EQ(t.tracer.source().stamp.t, 6.0);
}

TEST(EventTracer, ListsAllUpstreamPortsOfAChoice) {
  Network network = sensor_and_relay();
  network.routes.push_back({3, "y", 2, "translation", FieldType::kVec3});
  Traced t(network);
  const std::uint32_t y = t.port(3, "y");
  t.deliveries.insert(y, 10, Value::of_vec3({1, 1, 1}));
  ASSERT_TRUE(t.tracer.find(t.port(2, "translation"), 11, EventTracer::At::kNow));
  EXPECT_EQ(t.tracer.source().port, y);
  EXPECT_THAT(t.tracer.upstream(), testing::UnorderedElementsAre(t.port(2, "translation"), t.port(1, "value_changed"),
                                                                 t.port(0, "fraction_changed"), y));
}

TEST(EventTracer, AnswersWithTheKeysOfTheTime) {
  Traced t;
  auto key_value = t.graph.find_or_add(1, "keyValue", FieldType::kVec3s, true);
  ASSERT_TRUE(key_value);
  t.deliveries.grow(t.graph.ports.size());
  t.tracer.grow(t.graph.ports.size());
  Value keys;
  keys.type = FieldType::kVec3s;
  keys.numbers = {0, 0, 0, 80, 0, 0};
  t.deliveries.insert(*key_value, 3, keys);
  EXPECT_EQ(t.tracer.keys_at(t.port(1, "value_changed"), 2.9).key_value[3], 8.0f);
  EXPECT_EQ(t.tracer.keys_at(t.port(1, "value_changed"), 3).key_value[3], 80.0f);
}

}  // namespace peerd::animation::event_tracer_test
