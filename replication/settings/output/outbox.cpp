#include "replication/settings/output/outbox.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {
namespace {

// Memory is kept for so many datagrams: as many as a peer sends at once, but for its first states.
constexpr std::size_t kSpareMax = 64;

}  // namespace

Outbox::Outbox(PeerId self, std::uint64_t incarnation, PeerCounters& counters)
    : self_(self), incarnation_(incarnation), counters_(counters) {
  assert(self != kNobody && incarnation != 0);
}

Message Outbox::blank() const {
  Message m;
  m.sender = self_;
  m.incarnation = incarnation_;
  return m;
}

std::uint32_t Outbox::send(Message& message, RegionId region, std::span<const EncodedUpdate> updates) {
  assert(message.sender == self_ && message.incarnation == incarnation_);
  message.number = ++numbers_[region];
  take_rider(region, message);
  put(region, message, updates);
  return message.number;
}

std::uint32_t Outbox::send_nearby(Message& message, std::span<const RegionId> regions,
                                  std::span<const EncodedUpdate> updates) {
  assert(message.sender == self_ && message.incarnation == incarnation_);
  assert(!regions.empty() && std::ranges::is_sorted(regions) && regions.front() != kWholeScene);
  message.nearby = true;
  message.number = ++numbers_[kNearby];
  for (const RegionId region : regions) {
    take_rider(region, message);
    put(region, message, updates);
  }
  return message.number;
}

void Outbox::send_unnumbered(const Message& message) {
  assert(message.sender == self_ && message.number == 0);
  put(kWholeScene, message, {});
}

void Outbox::ride(RegionId region, const GhostDigest& digest) {
  const auto at = std::ranges::find(riders_, region, &std::pair<RegionId, GhostDigest>::first);
  if (at == riders_.end()) {
    riders_.emplace_back(region, digest);
  } else {
    at->second = digest;
  }
}

void Outbox::take_rider(RegionId region, Message& message) {
  message.ghosts.reset();
  const auto at = std::ranges::find(riders_, region, &std::pair<RegionId, GhostDigest>::first);
  if (at == riders_.end()) return;
  message.ghosts = at->second;
  riders_.erase(at);
}

void Outbox::put(RegionId region, const Message& message, std::span<const EncodedUpdate> updates) {
  Bytes datagram;
  if (!spare_.empty()) {
    datagram = std::move(spare_.back());
    spare_.pop_back();
  }
  codec_.encode(message, updates, datagram);
  if (datagram.size() > kDatagramMax_bytes && message.ghosts) {  // the digest waits for the next one
    ride(region, *message.ghosts);
    Message without = message;
    without.ghosts.reset();
    codec_.encode(without, updates, datagram);
  }
  assert(datagram.size() <= kDatagramMax_bytes);
  ++counters_.datagrams_out;
  counters_.bytes_out += datagram.size();
  PeerCounters::Traffic& traffic = counters_.regions[region];
  ++traffic.datagrams_out;
  traffic.bytes_out += datagram.size();
  bytes_.spend(datagram.size(), !updates.empty());
  outputs_.push_back(Send{region, std::move(datagram)});
}

std::optional<Output> Outbox::poll() {
  assert(polled_ <= outputs_.size());
  if (polled_ < outputs_.size()) return std::move(outputs_[polled_++]);
  outputs_.clear();
  polled_ = 0;
  return std::nullopt;
}

void Outbox::reuse(Bytes&& datagram) {
  if (spare_.size() < kSpareMax) spare_.push_back(std::move(datagram));
}

std::uint32_t Outbox::last_number(RegionId region) const {
  const auto at = numbers_.find(region);
  return at == numbers_.end() ? 0 : at->second;
}

}  // namespace peerd::replication
