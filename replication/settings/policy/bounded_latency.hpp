#pragma once
#include <cassert>
#include <cstdint>

#include "core/time.hpp"

namespace peerd::replication {

// Local lag for all peers of a session (M. Mauve, J. Vogel, V. Hilt, W. Effelsberg: Local-lag and timewarp, IEEE
// Transactions on Multimedia 6, 2004), which needs a known upper bound of the latency (Ohlenburg 2003, section 5.2).
// Every peer shows all objects, its own too, as they were published until `bound` ago: an update takes effect on all
// screens at its stamp + the bound. The same at all peers of a session.
struct BoundedLatency {
  Duration least{0};           // the bound; where it is measured, it is never shorter. At most kBoundMax
  bool measured = false;       // the bound follows the latencies that the peers publish (BoundedDelay)
  std::uint32_t tick_hz = 60;  // of the session's peers, > 0; a measured bound goes by it

  // How much longer a measured bound is than the longest latency: two ticks, for an update may be of up to a tick
  // before it goes out, and its second copy, where the first is lost, goes out a tick later; and a tenth of a tick by
  // which session clocks may differ. 35 ms at 60 Hz.
  [[nodiscard]] Duration margin() const {
    assert(tick_hz > 0);
    return Duration{std::chrono::seconds(21)} / (10 * std::int64_t{tick_hz});
  }
  [[nodiscard]] bool is_on() const { return measured || least > Duration{0}; }
  // Peers with another bound are of another session, and where it is measured, peers with other ticks. Without the mode
  // it is the hash that comes in.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t world_hash) const;
};

// Updates of more than 4 s are not taken, and the past of objects is kept for 6 s: a longer bound would show what
// nobody knows any more.
inline constexpr Duration kBoundMax = std::chrono::milliseconds(2000);

}  // namespace peerd::replication
