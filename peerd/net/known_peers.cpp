#include "peerd/net/known_peers.hpp"

#include <algorithm>
#include <utility>

namespace peerd::net {

using asio::ip::udp;

KnownPeers::KnownPeers(Options options) : options_(std::move(options)) {}

bool KnownPeers::is_known(const udp::endpoint& at) const {
  return std::ranges::find(peers_, at, &Peer::at) != peers_.end();
}

KnownPeers::Outcome KnownPeers::on_greeting(HostTime now, const udp::endpoint& from, const Greeting& greeting) {
  if (greeting.instance == options_.instance) {
    own_.insert(from);
    return Outcome::kOwn;
  }
  if (greeting.echo != options_.instance) return Outcome::kStranger;
  auto known = std::ranges::find(peers_, greeting.instance, &Peer::instance);
  if (known != peers_.end() && known->at != from) return Outcome::kTwice;
  if (greeting.leaving) {
    if (known != peers_.end()) peers_.erase(known);
    return Outcome::kLeft;
  }
  const bool is_new = known == peers_.end();
  if (is_new) {
    std::erase_if(peers_, [&](const Peer& peer) { return peer.at == from; });  // started again
    if (peers_.size() >= options_.most) return Outcome::kFull;
    peers_.push_back({.at = from, .instance = greeting.instance});
    known = peers_.end() - 1;
  }
  introduced_.erase(from);
  known->heard = now;
  known->all_regions = greeting.all_regions;
  known->regions = greeting.regions;
  for (const udp::endpoint& other : greeting.peers) {
    if (other.port() == 0 || other.address().is_unspecified() || other.address().is_multicast()) continue;
    if (is_known(other) || own_.contains(other)) continue;
    if (introduced_.contains(other) || introduced_.size() < options_.most) {
      introduced_[other] = now + options_.introduction;
    }
  }
  return is_new ? Outcome::kNew : Outcome::kKnown;
}

void KnownPeers::forget(HostTime now) {
  std::erase_if(peers_, [&](const Peer& peer) { return now - peer.heard > options_.silence; });
  std::erase_if(introduced_, [&](const auto& entry) { return now > entry.second; });
}

bool KnownPeers::wants(const Peer& peer, RegionId region) {
  return peer.all_regions || std::ranges::binary_search(peer.regions, region);
}

std::vector<udp::endpoint> KnownPeers::candidates() const {
  std::vector<udp::endpoint> found;
  for (const udp::endpoint& seed : options_.seeds) {
    if (!is_known(seed) && !own_.contains(seed) && std::ranges::find(found, seed) == found.end()) found.push_back(seed);
  }
  for (const auto& [at, until] : introduced_) {
    if (!is_known(at) && std::ranges::find(found, at) == found.end()) found.push_back(at);
  }
  return found;
}

std::vector<udp::endpoint> KnownPeers::introductions(const Peer& to, std::size_t round) const {
  std::vector<udp::endpoint> named;
  for (std::size_t i = 0; i < peers_.size() && named.size() < kGreetingPeersMax; ++i) {
    const Peer& peer = peers_[(i + round * kGreetingPeersMax) % peers_.size()];
    if (peer.at == to.at || (peer.at.address().is_loopback() && !to.at.address().is_loopback())) continue;
    named.push_back(peer.at);
  }
  return named;
}

}  // namespace peerd::net
