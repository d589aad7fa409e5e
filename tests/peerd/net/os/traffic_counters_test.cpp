#include "peerd/net/os/traffic_counters.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <set>

namespace peerd::net::traffic_counters_test {

constexpr std::size_t kCounters = sizeof(TrafficCounters) / sizeof(std::uint64_t);

TEST(TrafficCounters, EachHasANameOfItsOwn) {
  std::array<std::uint64_t, kCounters> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i + 1;
  std::set<std::uint64_t> named;
  for (const auto& [name, value] : std::bit_cast<TrafficCounters>(values).named()) {
    EXPECT_TRUE(name.starts_with("net.")) << name;
    EXPECT_TRUE(named.insert(value).second) << name << " is the value of another one";
  }
  EXPECT_EQ(named.size(), kCounters) << "a counter is not reported";
}

TEST(TrafficCounters, NamesAreThoseOfTheMembers) {
  const TrafficCounters counters{.packets_in = 1, .in_queue_overflow = 2, .out_blocked = 3, .peers_refused = 4};
  const auto named = counters.named();
  EXPECT_EQ(named.at("net.packets_in"), 1u);
  EXPECT_EQ(named.at("net.in_queue_overflow"), 2u);
  EXPECT_EQ(named.at("net.out_blocked"), 3u);
  EXPECT_EQ(named.at("net.peers_refused"), 4u);
  EXPECT_EQ(named.at("net.packets_out"), 0u);
}

}  // namespace peerd::net::traffic_counters_test
