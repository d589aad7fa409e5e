#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <tuple>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::sim {

// The time that all simulated peers share and none can read.
using VirtualTime = InjectedClock<struct VirtualClockTag>::time_point;

// The draws of one link. A Mersenne twister has 2.5 KB of state, of which a million links would need more than a
// computer has: it is made with the first draw, and where peers are on islands, a splitmix64 of 8 bytes takes its
// place on all links, those that no island changes included: they draw otherwise than without islands.
class LinkDraws {
 public:
  LinkDraws(std::uint64_t seed, bool is_small) : state_(seed), is_small_(is_small) {}
  [[nodiscard]] std::uint64_t next();

 private:
  std::uint64_t state_;  // the seed, until there is a twister
  bool is_small_;
  std::unique_ptr<std::mt19937_64> twister_;
};

// One direction between two peers. Each has a generator of its own, seeded from the run's seed and the link's two ends,
// so that the draws of one link change nothing on another.
class Link {
 public:
  Link(const config::LinkSettings& settings, std::uint64_t seed, bool has_small_draws = false);
  // Delays of the copies of a datagram that leaves now: none where it is lost, two where it is duplicated.
  [[nodiscard]] std::vector<Duration> delays();
  void change(const config::LinkChange& change) { config::change_link(settings_, change); }

 private:
  [[nodiscard]] double uniform();  // in [0, 1)
  [[nodiscard]] bool lost();
  [[nodiscard]] Duration one_delay();

  config::LinkSettings settings_;
  LinkDraws random_;
  bool in_burst_ = false;
};

struct Delivery {
  VirtualTime at;
  std::uint64_t number;  // number of the sending; the older one goes first among equal times
  std::size_t from, to;  // indices of the peers
  RegionId region;
  std::shared_ptr<const replication::Bytes> datagram;

  friend bool operator>(const Delivery& a, const Delivery& b) {
    return std::tie(a.at, a.number) > std::tie(b.at, b.number);
  }
};

// Multicast between simulated peers: a datagram reaches each peer that has joined its region, by the link between the
// two.
class Network {
 public:
  // The run, which outlives the network, says what links begin with.
  explicit Network(const config::RunSettings& run);
  explicit Network(const config::RunSettings&& run) = delete;

  void join(std::size_t peer, RegionId region);
  void leave(std::size_t peer, RegionId region);
  void leave_all(std::size_t peer);
  // Datagrams do not cross between sides from now on; those under way arrive. `sides` is by peer; empty: no partition.
  void part(std::vector<std::uint32_t> sides) { sides_ = std::move(sides); }
  // Changes the link for all datagrams that are sent from now on.
  void change(std::size_t from, std::size_t to, const config::LinkChange& change) { link(from, to).change(change); }
  [[nodiscard]] bool joined(std::size_t peer, RegionId region) const;
  void send(VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram);

  [[nodiscard]] bool idle() const { return queue_.empty(); }
  [[nodiscard]] VirtualTime next_delivery() const { return queue_.top().at; }
  [[nodiscard]] Delivery take_next();

 private:
  [[nodiscard]] Link& link(std::size_t from, std::size_t to);

  const config::RunSettings& run_;
  std::size_t peers_;
  std::vector<std::unique_ptr<Link>> links_;             // index: from * peers + to; null: nothing has gone there yet
  std::map<RegionId, std::vector<std::size_t>> joined_;  // ascending peers of each region that has any
  std::vector<std::uint32_t> sides_;                     // side of each peer; empty: no partition
  std::priority_queue<Delivery, std::vector<Delivery>, std::greater<>> queue_;
  std::uint64_t sent_ = 0;
};

}  // namespace peerd::sim
