#pragma once
#include <optional>

#include "core/ids.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// The session time at which the world's TimeSensors began (their time 0), the same on all peers of a session, and the
// time at which this peer lets motions by formula begin.
class WorldTime {
 public:
  // The session time of time 0; none until a peer of the session has published it.
  [[nodiscard]] std::optional<SimTime> zero() const { return zero_; }
  [[nodiscard]] std::optional<SimTime> start() const { return start_; }

  // Motions by formula begin at `start`, and so does the world's time where the session has none yet.
  void announce_start(SimTime start);
  // This peer's time has stepped by `step` into the session of `source`, whose world time counts from now on.
  void on_other_session(Duration step, std::optional<PeerId> source);
  // `sender`, which has a session, says when the world's time began. True where that is new to this peer and counts:
  // the sender is the peer that this one follows, or nobody has said before.
  [[nodiscard]] bool on_zero(PeerId sender, std::optional<PeerId> follows, SimTime zero);
  // A peer has gone. True where it was the one that was to say when the world's time began and never said: this peer's
  // own goes on.
  [[nodiscard]] bool on_peer_lost(PeerId peer);

 private:
  std::optional<SimTime> start_;
  std::optional<SimTime> zero_;
  std::optional<SimTime> previous_zero_;  // of the session before, in today's session time
  std::optional<PeerId> zero_source_;     // the peer that brought this one into its session, and knows its zero
  bool clock_stepped_ = false;
};

}  // namespace peerd::replication
