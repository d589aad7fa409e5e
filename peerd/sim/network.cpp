#include "peerd/sim/network.hpp"

#include <algorithm>

#include "core/mixed_bits.hpp"

namespace peerd::sim {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014) gives unrelated seeds for neighbouring inputs.
std::uint64_t mixed(std::uint64_t x) { return mixed_bits(x + 0x9E3779B97F4A7C15ULL); }

}  // namespace

Link::Link(const config::LinkSettings& settings, std::uint64_t seed) : settings_(settings), random_(seed) {}

// The standard's distributions may differ between libraries, so this is done by hand.
double Link::uniform() { return static_cast<double>(random_() >> 11) * 0x1.0p-53; }

// Bursts follow Gilbert's model (1960), in the order of steps that the kernel's netem has: the state decides a
// datagram's fate, and then the state may change.
bool Link::lost() {
  if (settings_.loss_burst == 0.0) return uniform() < settings_.loss;
  const double leave = 1.0 / settings_.loss_burst, enter = leave * settings_.loss / (1.0 - settings_.loss);
  const bool lost = in_burst_;
  in_burst_ = uniform() < (lost ? 1.0 - leave : enter);
  return lost;
}

Duration Link::one_delay() {
  double delay_ms = settings_.latency_ms;
  if (settings_.jitter_ms > 0.0) delay_ms += settings_.jitter_ms * uniform();
  if (settings_.reordering > 0.0 && uniform() < settings_.reordering) {
    delay_ms += settings_.latency_ms + settings_.jitter_ms;
  }
  return from_seconds(delay_ms * 1e-3);
}

std::vector<Duration> Link::delays() {
  std::vector<Duration> delays;
  if (settings_.loss > 0.0 && lost()) return delays;
  delays.push_back(one_delay());
  if (settings_.duplication > 0.0 && uniform() < settings_.duplication) delays.push_back(one_delay());
  return delays;
}

Network::Network(const config::RunSettings& run) : peers_(run.peers.size()), joined_(run.peers.size()) {
  for (const auto& from : run.peers) {
    for (const auto& to : run.peers) {
      const std::uint64_t seed = mixed(run.seed ^ mixed(from.id ^ mixed(to.id)));
      links_.emplace_back(config::link(run, from.name, to.name), seed);
    }
  }
}

void Network::join(std::size_t peer, RegionId region) {
  auto& regions = joined_[peer];
  const auto at = std::ranges::lower_bound(regions, region);
  if (at == regions.end() || *at != region) regions.insert(at, region);
}

void Network::leave(std::size_t peer, RegionId region) { std::erase(joined_[peer], region); }

bool Network::joined(std::size_t peer, RegionId region) const {
  return std::ranges::binary_search(joined_[peer], region);
}

void Network::send(VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram) {
  const auto shared = std::make_shared<const replication::Bytes>(std::move(datagram));
  for (std::size_t to = 0; to < peers_; ++to) {
    if (to == from || !joined(to, region)) continue;
    if (!sides_.empty() && sides_[from] != sides_[to]) continue;
    for (const Duration delay : links_[from * peers_ + to].delays()) {
      queue_.push({now + delay, sent_++, from, to, region, shared});
    }
  }
}

Delivery Network::take_next() {
  Delivery d = queue_.top();
  queue_.pop();
  return d;
}

}  // namespace peerd::sim
