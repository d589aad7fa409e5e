#include "peerd/net/greeting/known_peers.hpp"

#include <algorithm>
#include <utility>

namespace peerd::net {

using asio::ip::udp;

namespace {

// A known peer that is silent for so long at its address, but greets from another one, has moved there. Two processes
// with two addresses each may know one another by the wrong pair: each sends from another address than the other knows.
// One of them must move first, for if both moved at once they would miss each other again.
constexpr Duration kMovesFirst = std::chrono::milliseconds(2'200), kMovesLater = std::chrono::milliseconds(4'200);

}  // namespace

KnownPeers::KnownPeers(Options options) : options_(std::move(options)), numbers_(options_.key, options_.number) {}

bool KnownPeers::has_echoed(const udp::endpoint& from) const {
  return std::ranges::any_of(peers_, [&](const Peer& peer) { return peer.at == from || peer.also == from; });
}

bool KnownPeers::is_known(const udp::endpoint& at) const {
  return std::ranges::find(peers_, at, &Peer::at) != peers_.end();
}

KnownPeers::Outcome KnownPeers::on_greeting(HostTime now, const udp::endpoint& from, const Greeting& greeting) {
  if (greeting.instance == instance()) {
    on_own(now, from, greeting);
    return Outcome::kOwn;
  }
  if (!numbers_.is_number_for(from, greeting.echo)) return Outcome::kUnverified;
  auto known = std::ranges::find(peers_, greeting.instance, &Peer::instance);
  if (known != peers_.end() && known->at != from) {
    known->also = from;  // the peer may know us by another of our addresses, and send from there
    if (now - known->last_received < (instance() < greeting.instance ? kMovesFirst : kMovesLater))
      return Outcome::kTwice;
    known->also = std::exchange(known->at, from);
  }
  if (greeting.leaving) {
    if (known != peers_.end()) peers_.erase(known);
    introduced_.erase(from);
    silent_.erase(from);
    return Outcome::kLeft;
  }
  const bool is_new = known == peers_.end();
  if (is_new) {
    std::erase_if(peers_,
                  [&](const Peer& peer) { return peer.at == from; });  // the process at that address has restarted
    if (peers_.size() >= options_.most) return Outcome::kFull;
    peers_.push_back({.at = from, .instance = greeting.instance});
    known = peers_.end() - 1;
  }
  introduced_.erase(from);
  silent_.erase(from);
  known->last_received = now;
  known->number = greeting.number;
  if (!greeting.reply) {  // a greeting that wants a reply is bare, and changes no regions
    known->all_regions = greeting.all_regions;
    known->regions = greeting.regions;
  }
  for (const udp::endpoint& other : greeting.peers) {
    if (other.port() == 0 || other.address().is_unspecified() || other.address().is_multicast()) continue;
    if (is_known(other) || own_.contains(other)) continue;
    introduce(other, now + options_.introduction);
  }
  return is_new ? Outcome::kNew : Outcome::kKnown;
}

// Only the process that receives at `from` can send our number for that address, and only candidates are remembered.
void KnownPeers::on_own(HostTime now, const udp::endpoint& from, const Greeting& greeting) {
  const bool candidate = introduced_.contains(from) || std::ranges::find(options_.seeds, from) != options_.seeds.end();
  if (!numbers_.is_number_for(from, greeting.number) || !candidate) return;
  if (own_.size() < options_.most || own_.contains(from)) own_[from] = now + options_.own;
  introduced_.erase(from);
}

// The time is never shortened: a silent peer that others name is greeted for the longer of both times.
void KnownPeers::introduce(const udp::endpoint& at, HostTime until) {
  if (!introduced_.contains(at) && introduced_.size() >= options_.most) return;
  HostTime& greeted_until = introduced_.try_emplace(at, until).first->second;
  greeted_until = std::max(greeted_until, until);
}

void KnownPeers::forget(HostTime now) {
  numbers_.advance(now);
  std::erase_if(introduced_, [&](const auto& entry) { return now > entry.second; });
  std::erase_if(own_, [&](const auto& entry) { return now > entry.second; });
  std::erase_if(peers_, [&](const Peer& peer) {
    if (now - peer.last_received <= options_.silence) return false;
    introduce(peer.at, now + options_.again);  // the peer that named it may have left by now
    note_silent(now, peer.at);
    return true;
  });
  for (auto& [at, silent] : silent_) {
    if (now < silent.due) continue;
    introduce(at, now + options_.introduction);
    silent.due = now + options_.rarely;
  }
}

// Nobody else may be left who names it, however long the network was away. Of too many, the one that has been silent
// for the longest time is forgotten.
void KnownPeers::note_silent(HostTime now, const udp::endpoint& at) {
  if (silent_.size() >= options_.most && !silent_.contains(at)) {
    silent_.erase(std::ranges::min_element(silent_, {}, [](const auto& each) { return each.second.since; }));
  }
  silent_[at] = {now, now + options_.again};
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
