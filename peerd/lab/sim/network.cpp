#include "peerd/lab/sim/network.hpp"

#include <algorithm>

#include "core/mixed_bits.hpp"

namespace peerd::sim {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014) gives unrelated seeds for neighbouring inputs.
std::uint64_t mixed(std::uint64_t x) { return mixed_bits(x + 0x9E3779B97F4A7C15ULL); }

}  // namespace

std::uint64_t LinkDraws::next() {
  if (is_small_) return mixed_bits(state_ += 0x9E3779B97F4A7C15ULL);
  if (!twister_) twister_ = std::make_unique<std::mt19937_64>(state_);
  return (*twister_)();
}

Link::Link(const config::LinkSettings& settings, std::uint64_t seed, bool has_small_draws)
    : settings_(settings), random_(seed, has_small_draws) {}

// The standard's distributions may differ between libraries, so this is done by hand.
double Link::uniform() { return static_cast<double>(random_.next() >> 11) * 0x1.0p-53; }

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

Network::Network(const config::RunSettings& run)
    : run_(run), peers_(run.peers.size()), links_(run.peers.size() * run.peers.size()) {}

// Links are made as they are used: of a large session most are between peers that hear nothing of each other.
Link& Network::link(std::size_t from, std::size_t to) {
  std::unique_ptr<Link>& link = links_[from * peers_ + to];
  if (link) return *link;
  const config::PeerSettings &sender = run_.peers[from], &receiver = run_.peers[to];
  const std::uint64_t seed = mixed(run_.seed ^ mixed(sender.id ^ mixed(receiver.id)));
  link = std::make_unique<Link>(config::link(run_, sender.name, receiver.name), seed, !run_.islands.empty());
  return *link;
}

void Network::join(std::size_t peer, RegionId region) {
  std::vector<std::size_t>& peers = joined_[region];
  const auto at = std::ranges::lower_bound(peers, peer);
  if (at == peers.end() || *at != peer) peers.insert(at, peer);
}

void Network::leave(std::size_t peer, RegionId region) {
  const auto at = joined_.find(region);
  if (at == joined_.end()) return;
  std::erase(at->second, peer);
  if (at->second.empty()) joined_.erase(at);
}

void Network::leave_all(std::size_t peer) {
  for (auto& [region, peers] : joined_) std::erase(peers, peer);
  std::erase_if(joined_, [](const auto& each) { return each.second.empty(); });
}

bool Network::joined(std::size_t peer, RegionId region) const {
  const auto at = joined_.find(region);
  return at != joined_.end() && std::ranges::binary_search(at->second, peer);
}

void Network::send(VirtualTime now, std::size_t from, RegionId region, replication::Bytes datagram) {
  const auto receivers = joined_.find(region);
  if (receivers == joined_.end()) return;
  const auto shared = std::make_shared<const replication::Bytes>(std::move(datagram));
  for (const std::size_t to : receivers->second) {
    if (to == from) continue;
    if (!sides_.empty() && sides_[from] != sides_[to]) continue;
    for (const Duration delay : link(from, to).delays()) {
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
