#include "core/animation/change_tracker.hpp"

#include <gmock/gmock.h>

#include "tests/core/animation/graph_fixture.hpp"

namespace peerd::animation::change_tracker_test {

using testing::ElementsAre;
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

TEST(ChangeTracker, ListsAFieldWhileItsSensorRuns) {
  Tracked t;
  const FieldId field{t.port(2, "translation")};
  EXPECT_THAT(t.changing(0, 1), IsEmpty());
  EXPECT_THAT(t.changing(1, 2), ElementsAre(field));  // it starts at 2
  EXPECT_THAT(t.changing(3, 4), ElementsAre(field));
  EXPECT_THAT(t.changing(5, 8), ElementsAre(field));  // it stops at 6
  EXPECT_THAT(t.changing(8, 9), IsEmpty());
  EXPECT_THAT(t.changing(0, 1), IsEmpty());  // time may go back
  EXPECT_THAT(t.changing(0, 100), ElementsAre(field));
}

TEST(ChangeTracker, ListsADeliveryOnceAndEverythingBehindIt) {
  Tracked t;
  const std::uint32_t x = t.port(3, "x"), y = t.port(4, "x");
  EXPECT_THAT(t.changing(10, 11), IsEmpty());
  t.deliveries.insert(x, 12, Value::of_float(1));
  t.tracker.note_delivery(x, 12);
  EXPECT_THAT(t.changing(11, 11.5), IsEmpty());
  EXPECT_THAT(t.changing(11.5, 12), ElementsAre(FieldId{std::min(x, y)}, FieldId{std::max(x, y)}));
  EXPECT_THAT(t.changing(12, 13), IsEmpty());
}

TEST(ChangeTracker, ListsADeliveryOfThePast) {
  Tracked t;
  const std::uint32_t x = t.port(3, "x");
  EXPECT_THAT(t.changing(10, 11), IsEmpty());
  t.deliveries.insert(x, 7, Value::of_float(1));
  t.tracker.note_delivery(x, 7);
  EXPECT_THAT(t.changing(11, 12), testing::SizeIs(2));
  EXPECT_THAT(t.changing(12, 13), IsEmpty());
}

TEST(ChangeTracker, FindsDeliveriesThatWereNotedBeforeTheFirstQuestion) {
  Tracked t;
  const std::uint32_t x = t.port(3, "x");
  t.deliveries.insert(x, 12, Value::of_float(1));
  t.tracker.note_delivery(x, 12);
  EXPECT_THAT(t.changing(10, 11), IsEmpty());
  EXPECT_THAT(t.changing(11, 12), testing::SizeIs(2));
}

}  // namespace peerd::animation::change_tracker_test
