#include "peerd/peer/node/counter_meanings.hpp"

#include <gtest/gtest.h>

#include "peerd/net/os/traffic_counters.hpp"
#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::counter_meanings_test {

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF DRIVEN Transform { children Shape { geometry Box { } } }
)";

TEST(CounterMeanings, EveryCounterOfAPeerHasOne) {
  testing_support::LonePeer peer(kWorld, {"A", "DRIVEN"});
  peer.make({{.at_s = 0.1, .key = {}}});
  peer.run(1);
  const auto& counters = peer.node->log().counters;
  EXPECT_TRUE(counters.contains("keys"));
  EXPECT_TRUE(counters.contains("updates_out_up_to_16_bytes"));
  for (const auto& [name, count] : counters) EXPECT_FALSE(meaning_of_counter(name).empty()) << name;
}

TEST(CounterMeanings, EveryCounterOfATransportHasOne) {
  for (const auto& [name, count] : net::TrafficCounters().named()) {
    EXPECT_FALSE(meaning_of_counter(name).empty()) << name;
  }
}

TEST(CounterMeanings, ReasonsAreInTheNames) {
  EXPECT_FALSE(meaning_of_counter("dropped_stale_boot").empty());
  EXPECT_FALSE(meaning_of_counter("poses_refused_not_fed").empty());
  EXPECT_TRUE(meaning_of_counter("no_counter").empty());
}

}  // namespace peerd::counter_meanings_test
