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

}  // namespace peerd::animation::event_tracer_test
