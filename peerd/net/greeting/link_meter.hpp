#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"

namespace peerd::net {

// Measures a link with a relay by the notes in its greetings: round trip, loss in each direction, and the other end's
// clock. Sans-IO.
class LinkMeter {
 public:
  // The other clock minus this one lies within middle - error .. middle + error (RFC 5905, 8: half of the round trip).
  struct ClockOffset {
    Duration middle{0}, error{0};
  };

  void count_out() { ++out_; }
  void count_in() { ++in_; }

  // The note for a greeting that leaves now.
  [[nodiscard]] LinkNote note(HostTime now);
  // A note has arrived. False: it is no newer than the last one, so it was recorded or overtaken, or its time is not
  // after 1970; it counts for nothing.
  bool on_note(HostTime now, const LinkNote& note);

  // Smoothed with 1/8, as TCP's (RFC 6298, 2.3). None: nothing has been echoed.
  [[nodiscard]] std::optional<Duration> round_trip() const { return round_trip_; }
  // The offset by the shortest round trip of the last ten seconds or more.
  [[nodiscard]] std::optional<ClockOffset> clock() const { return clock_; }
  // The latency [ns] that no datagram of this link is expected to exceed: half of the mean round trip and twice the
  // deviation. None as round_trip().
  [[nodiscard]] std::optional<Duration> latency_bound() const;
  [[nodiscard]] double loss_in() const { return loss_in_.value(); }    // of the other end's datagrams, 0 to 1
  [[nodiscard]] double loss_out() const { return loss_out_.value(); }  // of this end's
  // More than a fifth of at least 200 datagrams is lost in a direction: what goes by another link does better.
  [[nodiscard]] bool is_lossy() const { return loss_in_.is_high() || loss_out_.is_high(); }

 private:
  // The share that is lost of the last thousand datagrams or so.
  class Loss {
   public:
    // Counts of both ends so far, modulo 2^32. What is older than the last datagram by half a minute is forgotten.
    void add(std::uint32_t sent, std::uint32_t received, HostTime now);
    [[nodiscard]] double value() const { return sent_ > 0.0 ? std::max(0.0, 1.0 - received_ / sent_) : 0.0; }
    [[nodiscard]] bool is_high() const { return sent_ >= 200.0 && value() > 0.2; }

   private:
    std::optional<std::uint32_t> sent_before_, received_before_;
    double sent_ = 0.0, received_ = 0.0;
    HostTime changed_{};
  };

  std::uint32_t out_ = 0, in_ = 0;
  std::int64_t last_sent_ns_ = 0;
  std::optional<std::int64_t> last_note_ns_;  // sent_at_ns of the last note that came
  HostTime last_note_at_{};
  std::optional<Duration> round_trip_;
  Duration deviation_{0};
  std::optional<ClockOffset> clock_;
  HostTime clock_at_{};
  Loss loss_in_, loss_out_;
};

}  // namespace peerd::net
