#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "replication/settings/grid/region_grid.hpp"
#include "replication/settings/output/output.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/budget.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::replication {

// The outputs of a peer, in their order: encoded and numbered datagrams, and the events of output.hpp.
class Outbox {
 public:
  // `counters` outlive the outbox.
  Outbox(PeerId self, std::uint64_t incarnation, PeerCounters& counters);

  // A message of this peer with nothing in it yet.
  [[nodiscard]] Message blank() const;
  // Encodes a message to a region and numbers it; `updates`, whose times count from the first one's, go in place of the
  // message's own. The result fits in kDatagramMax_bytes. Returns its number, from 1 in each region.
  std::uint32_t send(Message& message, RegionId region = kWholeScene, std::span<const EncodedUpdate> updates = {});
  // Encodes a message for near peers (Message::nearby), once to each of the regions: at least one, ascending. All
  // copies have one number, which is counted apart. Returns it.
  std::uint32_t send_nearby(Message& message, std::span<const RegionId> regions,
                            std::span<const EncodedUpdate> updates = {});
  // Encodes a message to all peers without a number: nobody counts it as one of this peer's.
  void send_unnumbered(const Message& message);
  // The digest goes with the next numbered datagram to that region which has room for it, in place of one that waits.
  void ride(RegionId region, const GhostDigest& digest);
  void forget_riders() { riders_.clear(); }
  [[nodiscard]] PeerId self() const { return self_; }
  void push(Output output) { outputs_.push_back(std::move(output)); }

  [[nodiscard]] std::optional<Output> poll();
  // Takes back the memory of a datagram that has been sent, so that the next ones need not allocate.
  void reuse(Bytes&& datagram);

  // The number of the last datagram to that region; 0 before the first.
  [[nodiscard]] std::uint32_t last_number(RegionId region = kWholeScene) const;
  [[nodiscard]] ByteBudget& bytes() { return bytes_; }

 private:
  void take_rider(RegionId region, Message& message);
  void put(RegionId region, const Message& message, std::span<const EncodedUpdate> updates);

  PeerId self_;
  std::uint64_t incarnation_;
  PeerCounters& counters_;
  Codec codec_;
  std::map<RegionId, std::uint32_t> numbers_;
  std::vector<std::pair<RegionId, GhostDigest>> riders_;  // at most one a region
  std::vector<Bytes> spare_;                              // memory for datagrams to come
  ByteBudget bytes_;
  std::vector<Output> outputs_;
  std::size_t polled_ = 0;  // the number of outputs_ that have been polled
};

}  // namespace peerd::replication
