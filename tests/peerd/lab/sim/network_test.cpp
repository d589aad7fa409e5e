#include "peerd/lab/sim/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/must.hpp"

namespace peerd::sim::network_test {

using std::chrono::milliseconds;
using testing::Pair;

constexpr VirtualTime kNow{std::chrono::seconds(1)};
constexpr RegionId kHere{0}, kThere{1};

config::RunSettings three_peers(const config::LinkSettings& link, std::uint64_t seed = 1) {
  config::RunSettings run{.seed = seed, .network = link};
  for (std::uint32_t id = 1; id <= 3; ++id) {
    auto& peer = run.peers.emplace_back();
    peer.name = std::string(1, static_cast<char>('a' + id - 1));
    peer.id = id;
  }
  return run;
}

replication::Bytes numbered(std::uint64_t n) {
  replication::Bytes bytes(sizeof n);
  std::memcpy(bytes.data(), &n, sizeof n);
  return bytes;
}
std::uint64_t number_of(const Delivery& d) {
  std::uint64_t n = 0;
  std::memcpy(&n, d.datagram->data(), sizeof n);
  return n;
}
std::vector<Delivery> drain(Network& network) {
  std::vector<Delivery> all;
  while (!network.idle()) all.push_back(network.take_next());
  return all;
}

TEST(Network, ReachesWhoeverHasJoinedTheRegionButTheSender) {
  const config::RunSettings run = three_peers({.latency_ms = 2});
  Network network(run);
  network.join(0, kHere);
  network.join(1, kHere), network.join(1, kHere);
  network.join(2, kThere);
  network.send(kNow, 0, kHere, numbered(7));
  auto got = only(drain(network));
  EXPECT_EQ(got.to, 1u);
  EXPECT_EQ(got.region, kHere);
  EXPECT_EQ(number_of(got), 7u);
  network.send(kNow, 0, kThere, numbered(8));  // no need to have joined what one sends to
  EXPECT_EQ(drain(network).at(0).to, 2u);
  network.leave(1, kHere);
  network.send(kNow, 0, kHere, numbered(9));
  EXPECT_TRUE(network.idle());
}

TEST(Network, LatencyIsExactAndOldDatagramsGoFirst) {
  const config::RunSettings run = three_peers({.latency_ms = 12.5});
  Network network(run);
  for (std::size_t p = 0; p < 3; ++p) network.join(p, kHere);
  for (std::uint64_t n = 0; n < 100; ++n) network.send(kNow + milliseconds(n / 10), 0, kHere, numbered(n));
  std::vector<std::uint64_t> at_b;
  for (const Delivery& d : drain(network)) {
    const auto n = number_of(d);
    EXPECT_EQ(d.at, kNow + milliseconds(n / 10) + std::chrono::microseconds(12'500));
    if (d.to == 1) at_b.push_back(n);
  }
  EXPECT_EQ(at_b.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(at_b)) << "of one instant in the order of sending";
}

// ---- rates: each within five standard deviations of its binomial, which one seed in 1.7 million would leave ----

constexpr int kSends = 20'000;
void expect_rate(double counted, double probability, const char* what) {
  const double sigma = std::sqrt(kSends * probability * (1 - probability));
  EXPECT_NEAR(counted, kSends * probability, 5 * sigma) << what << ", seed 1";
}
// The datagrams that arrive at b of kSends, one a second.
std::vector<Delivery> flood(const config::RunSettings& run, std::size_t to = 1) {
  Network network(run);
  network.join(to, kHere);
  for (std::uint64_t n = 0; n < kSends; ++n) network.send(kNow + std::chrono::seconds(n), 0, kHere, numbered(n));
  return drain(network);
}

TEST(LinkRates, Loss) {
  for (const double loss : {0.01, 0.2, 0.9}) {
    expect_rate(kSends - static_cast<double>(flood(three_peers({.loss = loss})).size()), loss, "lost");
  }
  EXPECT_EQ(flood(three_peers({.loss = 1.0})).size(), 0u);
  EXPECT_EQ(flood(three_peers({})).size(), static_cast<std::size_t>(kSends));
}

// The link loses as much as the settings ask for, in runs of the length that they ask for, and between two runs a
// datagram arrives.
TEST(LinkRates, LossInBursts) {
  for (const auto& [loss, burst] : {std::pair{0.05, 5.0}, {0.2, 3.0}, {0.5, 1.0}, {0.01, 40.0}}) {
    std::vector<bool> arrived(kSends);
    for (const Delivery& d : flood(three_peers({.loss = loss, .loss_burst = burst}))) arrived[number_of(d)] = true;
    int lost = 0, runs = 0;
    for (int i = 0; i < kSends; ++i) {
      lost += !arrived[i];
      runs += !arrived[i] && (i == 0 || arrived[i - 1]);
    }
    // Two states: the variance of a share is that of independent draws times (1 + m) / (1 - m), m = 1 - enter - leave.
    const double leave = 1.0 / burst, enter = leave * loss / (1.0 - loss), m = 1.0 - enter - leave;
    const double sigma = std::sqrt(kSends * loss * (1.0 - loss) * (1.0 + m) / (1.0 - m));
    EXPECT_NEAR(lost, kSends * loss, 5 * sigma) << loss << ' ' << burst;
    ASSERT_GT(runs, 0);
    // A run's length is geometric.
    EXPECT_NEAR(static_cast<double>(lost) / runs, burst, 5 * std::sqrt(burst * (burst - 1.0) / runs)) << loss;
  }
}

TEST(LinkRates, Duplication) {
  expect_rate(static_cast<double>(flood(three_peers({.duplication = 0.1})).size()) - kSends, 0.1, "duplicated");
  EXPECT_EQ(flood(three_peers({.duplication = 1.0})).size(), 2u * kSends);
}

TEST(LinkRates, Reordering) {
  int held_back = 0;
  for (const Delivery& d : flood(three_peers({.latency_ms = 10, .jitter_ms = 4, .reordering = 0.05}))) {
    const double ms = 1e3 * to_seconds(d.at - kNow - std::chrono::seconds(number_of(d)));
    EXPECT_TRUE((ms >= 10 && ms < 14) || (ms >= 24 && ms < 28)) << ms;
    held_back += ms >= 24;
  }
  expect_rate(held_back, 0.05, "held back");
}

TEST(LinkRates, JitterIsUniform) {
  double sum = 0;
  int upper_half = 0;
  for (const Delivery& d : flood(three_peers({.latency_ms = 10, .jitter_ms = 20}))) {
    const double ms = 1e3 * to_seconds(d.at - kNow - std::chrono::seconds(number_of(d)));
    ASSERT_GE(ms, 10.0);
    ASSERT_LT(ms, 30.0);
    sum += ms;
    upper_half += ms >= 20;
  }
  EXPECT_NEAR(sum / kSends, 20.0, 5 * 20 / std::sqrt(12.0 * kSends));
  expect_rate(upper_half, 0.5, "in the upper half");
}

TEST(LinkRates, JitterLetsLaterOnesOvertake) {
  const config::RunSettings run = three_peers({.jitter_ms = 20});
  Network network(run);
  network.join(1, kHere);
  for (std::uint64_t n = 0; n < 100; ++n) network.send(kNow + milliseconds(n), 0, kHere, numbered(n));
  std::vector<std::uint64_t> order;
  for (const Delivery& d : drain(network)) order.push_back(number_of(d));
  EXPECT_FALSE(std::ranges::is_sorted(order));
}

// ---- seeds and links ----

std::vector<std::pair<std::uint64_t, std::int64_t>> rows(const std::vector<Delivery>& deliveries) {
  std::vector<std::pair<std::uint64_t, std::int64_t>> all;
  for (const Delivery& d : deliveries) all.emplace_back(number_of(d), d.at.time_since_epoch().count());
  return all;
}

const config::LinkSettings kRough{.latency_ms = 5, .jitter_ms = 9, .loss = 0.2, .duplication = 0.1, .reordering = 0.1};

TEST(LinkSeeds, TheSameSeedDrawsTheSame) {
  EXPECT_EQ(rows(flood(three_peers(kRough))), rows(flood(three_peers(kRough))));
  EXPECT_NE(rows(flood(three_peers(kRough, 1))), rows(flood(three_peers(kRough, 2))));
}

TEST(LinkSeeds, EachLinkDrawsItsOwn) {
  EXPECT_NE(rows(flood(three_peers(kRough), 1)), rows(flood(three_peers(kRough), 2)));
}

// The draws of a -> c change nothing of a -> b: neither another loss there nor a missing listener.
TEST(LinkSeeds, WhatOneLinkDrawsChangesNothingOnAnother) {
  const auto at_b = [](const config::RunSettings& run, bool c_listens) {
    Network network(run);
    network.join(1, kHere);
    if (c_listens) network.join(2, kHere);
    for (std::uint64_t n = 0; n < 1000; ++n) network.send(kNow + std::chrono::seconds(n), 0, kHere, numbered(n));
    std::vector<Delivery> all = drain(network);
    std::erase_if(all, [](const Delivery& d) { return d.to != 1; });
    return rows(all);
  };
  config::RunSettings run = three_peers(kRough);
  const auto alone = at_b(run, false);
  EXPECT_EQ(at_b(run, true), alone);
  run.links[{"a", "c"}] = {.latency_ms = 500, .loss = 0.9};
  EXPECT_EQ(at_b(run, true), alone);
}

// With islands all links draw from the smaller generator, the one from a to b too, which the island has no part in.
TEST(LinkSeeds, IslandsChangeTheDrawsOfAllLinks) {
  config::RunSettings run = three_peers(kRough);
  const auto without = rows(flood(run));
  run.islands.push_back(kRough);
  run.island_of = {{"c", 0}};
  const auto with = rows(flood(run));
  EXPECT_NE(with, without);
  EXPECT_EQ(with, rows(flood(run))) << "which the seed alone decides";
}

TEST(LinkSeeds, ALinkOfItsOwnHoldsOneWay) {
  config::RunSettings run = three_peers({.latency_ms = 5});
  run.links[{"a", "b"}] = {.latency_ms = 70};
  Network network(run);
  for (std::size_t p = 0; p < 3; ++p) network.join(p, kHere);
  network.send(kNow, 0, kHere, numbered(1));
  network.send(kNow, 1, kHere, numbered(2));
  std::vector<std::pair<std::size_t, std::int64_t>> arrivals;  // (sender's number * 10 + to, ms)
  for (const Delivery& d : drain(network)) {
    arrivals.emplace_back(number_of(d) * 10 + d.to, std::chrono::duration_cast<milliseconds>(d.at - kNow).count());
  }
  EXPECT_THAT(arrivals, testing::UnorderedElementsAre(Pair(11, 70), Pair(12, 5), Pair(20, 5), Pair(22, 5)));
}

}  // namespace peerd::sim::network_test
