#include "replication/session/world_time.hpp"

#include <utility>

namespace peerd::replication {

void WorldTime::announce_start(SimTime start) {
  start_ = start;
  if (!zero_) zero_ = start;
}

void WorldTime::on_other_session(Duration step, std::optional<PeerId> source) {
  if (zero_) previous_zero_ = std::exchange(zero_, std::nullopt);
  if (previous_zero_) *previous_zero_ += step;
  zero_source_ = source;
  clock_stepped_ = true;
}

bool WorldTime::on_zero(PeerId sender, std::optional<PeerId> follows, SimTime zero) {
  const bool counts = sender == follows || (!zero_ && (!clock_stepped_ || sender == zero_source_));
  if (!counts || zero == zero_) return false;
  zero_ = zero;
  previous_zero_.reset();
  return true;
}

bool WorldTime::on_peer_lost(PeerId peer) {
  if (zero_source_ != peer || zero_) return false;
  zero_source_.reset();
  clock_stepped_ = false;
  zero_ = std::exchange(previous_zero_, std::nullopt);
  return true;
}

}  // namespace peerd::replication
