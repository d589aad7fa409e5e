#include "peerd/net/greeting/link_meter.hpp"

#include <algorithm>

namespace peerd::net {
namespace {

constexpr Duration kClockHolds = std::chrono::seconds(10);
// A longer round trip is a number that somebody has made up.
constexpr Duration kRoundTripMax = std::chrono::seconds(60);
constexpr double kLossOver = 1000.0;  // datagrams
constexpr Duration kLossHolds = std::chrono::seconds(30);

std::int64_t ns_of(HostTime at) { return at.time_since_epoch().count(); }

}  // namespace

void LinkMeter::Loss::add(std::uint32_t sent, std::uint32_t received, HostTime now) {
  if (sent_before_) {
    const std::uint32_t more = sent - *sent_before_, came = received - *received_before_;
    const bool is_anew = more > 1u << 31 || came > 1u << 31;  // the other end counts from 0 again
    const bool is_old = more == 0 && now - changed_ > kLossHolds;
    if (is_anew || is_old) {
      sent_ = received_ = 0.0;
    } else {
      sent_ += more;
      received_ += came;
    }
  }
  if (sent_before_ != sent) changed_ = now;
  sent_before_ = sent;
  received_before_ = received;
  if (sent_ > kLossOver) {
    received_ *= kLossOver / 2.0 / sent_;
    sent_ = kLossOver / 2.0;
  }
}

LinkNote LinkMeter::note(HostTime now) {
  last_sent_ns_ = std::max(ns_of(now), last_sent_ns_ + 1);
  LinkNote note{.sent_at_ns = last_sent_ns_, .datagrams_out = out_, .datagrams_in = in_};
  if (last_note_ns_) {
    note.echoed_ns = *last_note_ns_;
    note.held_us = static_cast<std::uint32_t>((now - last_note_at_) / std::chrono::microseconds(1));
  }
  return note;
}

bool LinkMeter::on_note(HostTime now, const LinkNote& note) {
  if (note.sent_at_ns <= last_note_ns_.value_or(0)) return false;
  last_note_ns_ = note.sent_at_ns;
  last_note_at_ = now;
  loss_in_.add(note.datagrams_out, in_, now);
  loss_out_.add(out_, note.datagrams_in, now);
  if (note.echoed_ns <= 0 || note.echoed_ns > last_sent_ns_) return true;
  const Duration away = Duration(ns_of(now) - note.echoed_ns) - std::chrono::microseconds(note.held_us);
  if (away < Duration{0} || away > kRoundTripMax) return true;
  const Duration off = !round_trip_ ? Duration{0} : away > *round_trip_ ? away - *round_trip_ : *round_trip_ - away;
  deviation_ = round_trip_ ? deviation_ + (off - deviation_) / 4 : away / 2;
  round_trip_ = round_trip_ ? *round_trip_ + (away - *round_trip_) / 8 : away;
  if (clock_ && clock_->error < away / 2 && now - clock_at_ < kClockHolds) return true;
  // The note left the other end between this end's echoed sending and its arrival here.
  clock_ = ClockOffset{Duration(note.sent_at_ns - ns_of(now)) + away / 2, away / 2};
  clock_at_ = now;
  return true;
}

std::optional<Duration> LinkMeter::latency_bound() const {
  if (!round_trip_) return std::nullopt;
  return *round_trip_ / 2 + 2 * deviation_;
}

}  // namespace peerd::net
