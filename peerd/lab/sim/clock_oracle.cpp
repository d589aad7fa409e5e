#include "peerd/lab/sim/clock_oracle.hpp"

#include <algorithm>

namespace peerd::sim {

void ClockOracle::take_sample(HostTime now, std::size_t i) {
  const replication::Peer& peer = peers_[i].node->peer();
  const auto follows = peer.follows();
  if (!peer.clock().synchronised() || !follows || follows == peer.id()) return;
  const auto followed = std::ranges::find(peers_, *follows, [](const WatchedPeer& p) { return p.node->peer().id(); });
  if (followed == peers_.end() || !followed->node->peer().clock().synchronised()) return;
  const SimTime own = peer.clock().to_session(now + peers_[i].clock_offset);
  const SimTime right = followed->node->peer().clock().to_session(now + followed->clock_offset);
  const Duration error = std::chrono::abs(own - right);
  const Duration bound = *peer.clock().error_bound(now + peers_[i].clock_offset);
  seen_[i].errors.push_back(error);
  seen_[i].bounds.push_back(bound);
  seen_[i].beyond += error > bound;
}

std::optional<PeerLog::ClockError> ClockOracle::error_of(std::size_t i) const {
  if (seen_[i].errors.empty()) return std::nullopt;
  std::vector<Duration> errors = seen_[i].errors, bounds = seen_[i].bounds;
  std::ranges::sort(errors);
  std::ranges::sort(bounds);
  const std::size_t n = errors.size();
  return PeerLog::ClockError{
      n, errors[(n * 99 + 99) / 100 - 1], errors.back(), bounds[n / 2], bounds.back(), seen_[i].beyond};
}

}  // namespace peerd::sim
