#include "core/animation/change_tracker.hpp"

#include <gmock/gmock.h>

#include "tests/core/animation/graph_fixture.hpp"

namespace peerd::animation::change_tracker_test {

using testing::IsEmpty;

struct Tracked : GraphFixture {
  explicit Tracked(const Network& network = sensor_and_relay())
      : GraphFixture(network), tracker(graph, simulator, deliveries) {
    tracker.grow(graph.ports.size());
  }
  std::vector<FieldId> changing(double from_s, double to_s) {
    std::vector<FieldId> out;
    tracker.changing(from_s, to_s, out);
    return out;
  }
  ChangeTracker tracker;
};

TEST(ChangeTracker, FindsDeliveriesThatWereNotedBeforeTheFirstQuestion) {
  Tracked t;
  const std::uint32_t x = t.port(3, "x");
  t.deliveries.insert(x, 12, Value::of_float(1));
  t.tracker.note_delivery(x, 12);
  EXPECT_THAT(t.changing(10, 11), IsEmpty());
  EXPECT_THAT(t.changing(11, 12), testing::SizeIs(2));
}

}  // namespace peerd::animation::change_tracker_test
