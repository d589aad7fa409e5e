#include "peerd/net/os/arrival_clock.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::net {

void ArrivalClock::on_pair(const HostClock::Pair& pair) {
  assert(pair.before <= pair.after && (!last_ || last_->after <= pair.before));
  const Duration least = pair.before.time_since_epoch() - pair.wall, most = pair.after.time_since_epoch() - pair.wall;
  const bool overlaps = least <= host_minus_wall_most_ + kRounding && most + kRounding >= host_minus_wall_least_;
  if (last_ && !overlaps) stepped_ = pair.after;
  if (!last_ || !overlaps || most - least < host_minus_wall_most_ - host_minus_wall_least_) {
    host_minus_wall_least_ = least;
    host_minus_wall_most_ = most;
  }
  last_ = pair;
}

std::optional<HostTime> ArrivalClock::arrival(Duration wall_stamp, HostTime empty_at) const {
  assert(last_);
  // A queue that was empty after the step was found holds no datagram from before it.
  if (stepped_ && empty_at < *stepped_ + kStampToQueue) return std::nullopt;
  if (wall_stamp > last_->wall) return std::nullopt;  // in the future
  const Duration middle = host_minus_wall_least_ + (host_minus_wall_most_ - host_minus_wall_least_) / 2;
  const HostTime at{wall_stamp + middle};
  if (at < empty_at - kStampToQueue) return std::nullopt;  // it would have been in the queue that was empty
  return std::min(at, last_->after);
}

}  // namespace peerd::net
