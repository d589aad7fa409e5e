#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <span>
#include <vector>

#include "peerd/lab/chaos/plan.hpp"
#include "peerd/lab/chaos/random_stream.hpp"
#include "peerd/lab/sim/network.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::chaos {

// The checksum of UDP without its header (RFC 1071).
[[nodiscard]] std::uint16_t checksum(std::span<const std::byte> bytes);

// Multicast between simulated peers by links that lose, delay, repeat, reorder and damage datagrams, and that are cut
// in each direction by itself. A damaged datagram arrives with other bytes; its receiver can tell by the checksum.
class DamagedNetwork {
 public:
  DamagedNetwork(std::uint64_t seed, std::size_t peers, const LinkFaults& links);

  struct Arrival {
    sim::Delivery delivery;
    bool is_damaged = false;  // the checksum of its bytes is not the sender's
  };

  void join(std::size_t peer, RegionId region) { joined_[peer].insert(region); }
  void leave_all(std::size_t peer) { joined_[peer].clear(); }
  void leave(std::size_t peer, RegionId region) { joined_[peer].erase(region); }
  // All links are so from now on.
  void set_links(const LinkFaults& links);
  // Cuts what goes from one peer to another, or mends one such cut. There may be several at once.
  void cut(std::size_t from, std::size_t to, bool cuts);
  void mend_all();
  void send(sim::VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram);
  // Delivers it then.
  void put_off(Arrival arrival, sim::VirtualTime until);

  [[nodiscard]] bool idle() const { return queue_.empty(); }
  [[nodiscard]] sim::VirtualTime next_arrival() const { return queue_.top().delivery.at; }
  [[nodiscard]] Arrival take_next();

  struct Counters {
    std::uint64_t sent = 0, cut = 0, lost = 0, repeated = 0, damaged = 0;
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Later {
    bool operator()(const Arrival& a, const Arrival& b) const { return a.delivery > b.delivery; }
  };
  [[nodiscard]] replication::Bytes damaged(const replication::Bytes& datagram);

  std::size_t peers_;
  std::uint64_t seed_;
  std::uint64_t changes_ = 0;
  double damage_ = 0.0;
  std::vector<sim::Link> links_;  // from * peers + to
  std::vector<int> cuts_;         // as many as there are at once
  std::vector<std::set<RegionId>> joined_;
  Random random_;
  std::priority_queue<Arrival, std::vector<Arrival>, Later> queue_;
  std::uint64_t number_ = 0;
  Counters counters_;
};

}  // namespace peerd::chaos
