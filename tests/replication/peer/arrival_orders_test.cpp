// What a peer shows does not depend on the order in which updates, decisions, hellos and its own ticks come: all orders
// of all that arrives in a short time are tried, at each time of a small game.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::arrival_orders_test {

using namespace test;

// STRIKER of peer 1 goes to and fro in a corridor, A and B of peer 2 bounce between it, each other and the walls, and
// peer 3 watches.
std::string game() {
  return box("STRIKER", "0.5 0.5 0.5", "-1.5 0 0") +
         box("A", "0.5 0.5 0.5", "0.3 0 0", std::string("velocityVector 3.3 0 0") + kBounces) +
         box("B", "0.5 0.5 0.5", "1.9 0 0", std::string("velocityVector -6.1 0 0") + kBounces) +
         box("LEFT", "1 50 50", "-3.75 0 0") + box("RIGHT", "1 50 50", "3.75 0 0") +
         interest("A", "\"STRIKER\" \"B\" \"LEFT\" \"RIGHT\"") + interest("B", "\"STRIKER\" \"A\" \"LEFT\" \"RIGHT\"");
}

KinematicState to_and_fro(SimTime t) {
  const double s = to_seconds(t.time_since_epoch() - kEpoch), w = 2.3;
  return moving({-1.5 + 1.2 * std::sin(w * s), 0, 0}, {1.2 * w * std::cos(w * s), 0, 0},
                {-1.2 * w * w * std::sin(w * s), 0, 0});
}

// Something that happens to the watching peer: a datagram that comes, or a call of on_tick.
struct Event {
  Duration at{0};
  Bytes datagram;  // empty: a tick

  [[nodiscard]] bool is_tick() const { return datagram.empty(); }
};

struct Recorded {
  std::vector<Event> events;
  std::map<ObjectId, KinematicState> ghosts;  // of their owners, at the end
};

// Few ticks, low thresholds and updates that are due soon, so that much happens between two ticks.
PeerConfig player(std::uint32_t id, DecisionPolicy policy, std::vector<OwnedObject> owned = {}) {
  PeerConfig c = config(id, std::move(owned));
  c.tick_hz = 10;
  c.policy.error_threshold_m = 0.002;
  c.policy.time_threshold = 300ms;
  c.decisions.policy = policy;
  return c;
}
PeerConfig watcher(DecisionPolicy policy) { return player(3, policy); }

class AnyOrder : public testing::TestWithParam<DecisionPolicy> {
 protected:
  static constexpr Duration kEnd = 12s;
  World world{game(), {"STRIKER", "A", "B"}};
  const std::array<ObjectId, 3> objects{world["STRIKER"], world["A"], world["B"]};

  Recorded record() {
    Recorded recorded;
    Lan lan(world, {.latency = 0ms});
    lan.add(player(1, GetParam(), {{world["STRIKER"], true}}), 0s, {{world["STRIKER"], to_and_fro}});
    lan.add(player(2, GetParam(), {{world["A"], false}, {world["B"], false}}));
    lan.add(watcher(GetParam()));
    lan.on_send = [&](std::size_t from, RegionId region, const Message& m) {
      EXPECT_EQ(region, kWholeScene);
      if (from != 2) recorded.events.push_back({lan.now(), encode(m)});
    };
    std::uint64_t ticks = 0;
    while (lan.now() < kEnd) {
      lan.run_until(lan.now() + 1ms);
      // Calls come at whole milliseconds or between them; the exact time is the last one of the node.
      if (lan.node(2).ticks != ticks) recorded.events.push_back({lan.node(2).last_call, {}});
      ticks = lan.node(2).ticks;
    }
    std::ranges::stable_sort(recorded.events, {}, [](const Event& e) { return std::pair(e.at, e.is_tick()); });
    for (const ObjectId object : objects) {
      const std::size_t owner = object == objects[0] ? 0 : 1;
      recorded.ghosts[object] = lan.peer(owner).ghost(object, lan.session_now(owner));
    }
    EXPECT_GT(lan.peer(0).counters().decisions + lan.peer(1).counters().decisions, 3u);
    return recorded;
  }

  // What the watching peer shows after each of its ticks, by the number of the event.
  std::map<std::size_t, std::array<Vec3, 3>> replay(const std::vector<const Event*>& events) const {
    Peer peer(watcher(GetParam()), *world.model);
    std::map<std::size_t, std::array<Vec3, 3>> shown;
    Duration now{0};
    for (std::size_t k = 0; k < events.size(); ++k) {
      const Event& e = *events[k];
      now = std::max(now, e.at);
      const HostTime host{kEpoch + now};
      if (e.is_tick()) {
        peer.on_tick(host, {});
      } else {
        (void)peer.on_packet(host, kWholeScene, e.datagram);
      }
      while (peer.poll_output()) {
      }
      if (!e.is_tick() || !peer.clock().synchronised()) continue;
      const SimTime t = peer.clock().to_session(host);
      peer.advance_ghosts(t);  // as a viewer does: the last tick may have been before what has come since
      for (std::size_t i = 0; i < objects.size(); ++i) shown[k][i] = peer.ghost(objects[i], t).position;
    }
    return shown;
  }
};

// The ticks keep their order, and everything else comes in all orders, before, between and after them. From the first
// tick after all that on the peer shows what it would show after any other order.
TEST_P(AnyOrder, ShowsTheSameOnceAllHasCome) {
  const Recorded recorded = record();
  std::vector<const Event*> all;
  for (const Event& e : recorded.events) all.push_back(&e);
  const auto in_order = replay(all);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    EXPECT_LT((in_order.rbegin()->second[i] - recorded.ghosts.at(objects[i]).position).norm(), 1.0);
  }
  constexpr std::size_t kWindow = 5, kStep = 5;
  std::size_t orders = 0;
  const auto begin = std::ranges::find_if(recorded.events, [](const Event& e) { return e.at >= 2s; });
  for (auto first = static_cast<std::size_t>(begin - recorded.events.begin()); first + 60 < all.size();
       first += kStep) {
    std::array<std::size_t, kWindow> order;
    std::iota(order.begin(), order.end(), first);
    while (std::ranges::next_permutation(order).found) {
      std::size_t last_tick = 0;
      const bool ticks_keep_order = std::ranges::all_of(
          order, [&](std::size_t k) { return !recorded.events[k].is_tick() || std::exchange(last_tick, k) < k; });
      if (!ticks_keep_order) continue;
      ++orders;
      std::vector<const Event*> events = all;
      for (std::size_t k = 0; k < kWindow; ++k) events[first + k] = &recorded.events[order[k]];
      events.resize(first + 60);
      const auto shown = replay(events);
      for (auto at = shown.lower_bound(first + kWindow); at != shown.end(); ++at) {
        for (std::size_t i = 0; i < objects.size(); ++i) {
          ASSERT_LT((at->second[i] - in_order.at(at->first)[i]).norm(), 1e-9)
              << world.scene.path_of(objects[i]) << " after event " << at->first << ", events from " << first << " at "
              << to_seconds(recorded.events[first].at) << " s in the order "
              << testing::PrintToString(std::vector(order.begin(), order.end()));
        }
      }
    }
  }
  EXPECT_GT(orders, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Policies, AnyOrder,
                         testing::Values(DecisionPolicy::kId, DecisionPolicy::kVelocity,
                                         DecisionPolicy::kExpectedError),
                         [](const auto& each) { return "Policy" + std::to_string(static_cast<int>(each.param)); });

}  // namespace peerd::replication::arrival_orders_test
