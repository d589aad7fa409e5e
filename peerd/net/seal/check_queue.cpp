#include "peerd/net/seal/check_queue.hpp"

#include <algorithm>
#include <utility>

#include "peerd/net/os/next_after.hpp"

namespace peerd::seal {
bool CheckQueue::push(const net::Arrival& arrival, PeerId sender) {
  bool all_stay = true;
  if (size_ >= kMost) {  // the address with the most of them loses one
    (void)take_from(std::ranges::max_element(sources_, {}, [](const auto& each) { return each.second.size; }));
    all_stay = false;
  }
  Source& source = sources_[arrival.from.address()];
  std::deque<Waiting>& of_peer = source.peers[sender];
  if (of_peer.size() >= kOfPeerMax) return false;
  of_peer.push_back({arrival.region, {arrival.datagram.begin(), arrival.datagram.end()}, arrival.at, arrival.from});
  ++source.size;
  ++size_;
  return all_stay;
}

std::optional<CheckQueue::Waiting> CheckQueue::next(HostTime now) {
  if (size_ == 0 || checks_.tokens(kRate, now) < 1.0) return std::nullopt;
  const auto source = net::next_after(sources_, served_);
  served_ = source->first;
  return take_from(source);
}

CheckQueue::Waiting CheckQueue::take_from(std::map<boost::asio::ip::address, Source>::iterator source) {
  auto& [address, all] = *source;
  const auto peer = net::next_after(all.peers, all.served);
  all.served = peer->first;
  Waiting first = std::move(peer->second.front());
  peer->second.pop_front();
  if (peer->second.empty()) all.peers.erase(peer);
  --size_;
  if (--all.size == 0) sources_.erase(source);
  return first;
}

}  // namespace peerd::seal
