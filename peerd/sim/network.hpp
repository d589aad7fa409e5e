#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <queue>
#include <random>
#include <tuple>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/config/scenario.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::sim {

// The time that all simulated peers share and none can read.
using VirtualTime = InjectedClock<struct VirtualClockTag>::time_point;

// One direction between two peers. Each has a generator of its own, seeded from the run's seed and the link's two ends,
// so that the draws of one link change nothing on another.
class Link {
 public:
  Link(const config::LinkSettings& settings, std::uint64_t seed);
  // Delays of the copies of a datagram that leaves now: none where it is lost, two where it is duplicated.
  [[nodiscard]] std::vector<Duration> delays();
  void change(const config::LinkChange& change) { config::change_link(settings_, change); }

 private:
  [[nodiscard]] double uniform();  // in [0, 1)
  [[nodiscard]] bool lost();
  [[nodiscard]] Duration one_delay();

  config::LinkSettings settings_;
  std::mt19937_64 random_;
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
  explicit Network(const config::RunSettings& run);

  void join(std::size_t peer, RegionId region);
  void leave(std::size_t peer, RegionId region);
  void leave_all(std::size_t peer) { joined_[peer].clear(); }
  // Datagrams do not cross between sides from now on; those under way arrive. `sides` is by peer; empty: no partition.
  void part(std::vector<std::uint32_t> sides) { sides_ = std::move(sides); }
  // Changes the link for all datagrams that are sent from now on.
  void change(std::size_t from, std::size_t to, const config::LinkChange& change) {
    links_[from * peers_ + to].change(change);
  }
  [[nodiscard]] bool joined(std::size_t peer, RegionId region) const;
  void send(VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram);

  [[nodiscard]] bool idle() const { return queue_.empty(); }
  [[nodiscard]] VirtualTime next_delivery() const { return queue_.top().at; }
  [[nodiscard]] Delivery take_next();

 private:
  std::size_t peers_;
  std::vector<Link> links_;                    // index: from * peers + to
  std::vector<std::vector<RegionId>> joined_;  // sorted regions of each peer
  std::vector<std::uint32_t> sides_;           // side of each peer; empty: no partition
  std::priority_queue<Delivery, std::vector<Delivery>, std::greater<>> queue_;
  std::uint64_t sent_ = 0;
};

}  // namespace peerd::sim
