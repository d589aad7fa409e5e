#include "peerd/net/doctor/pair_probe.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "peerd/net/os/datagram_limits.hpp"

namespace peerd::doctor {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kReportsApart = milliseconds(200);
// Time for the other side to hear this one, too, before the stream begins, and for switches to learn who is in the
// group.
constexpr Duration kStreamAfter = milliseconds(500);
constexpr Duration kStreamApart = Duration{1'000'000'000 / 60};  // as a peer that sends at 60 Hz
constexpr std::size_t kStream_bytes = 300;
// UDP payloads, each sent kEach times: an Ethernet frame holds 1,472 bytes over IPv4, tunnels hold less; one is
// the longest that peers send.
constexpr std::array<std::size_t, 6> kLengths_bytes{576, 1000, net::kSentDatagramMax_bytes, 1300, 1400, 1472};
constexpr std::size_t kEach = 3;
constexpr std::size_t kMulticastMost_bytes = net::kSentDatagramMax_bytes;
constexpr Duration kLengthsApart = milliseconds(40);
// A side goes on reporting for so long after both are complete, so that the other side knows all, too.
constexpr Duration kLinger = milliseconds(1000);
// The longest time from meeting to the end, where the other side is not heard to the end.
constexpr Duration kMost = seconds(13);
// A session that is silent for so long may be replaced: the other side was started again.
constexpr Duration kSilence = seconds(1);
// A longer round trip is a mistake or a forgery.
constexpr Duration kRoundTripMost = seconds(10);

std::size_t index_of(Path path) { return static_cast<std::size_t>(path); }

}  // namespace

PairProbe::PairProbe(const Settings& settings, HostTime now) : settings_(settings), started_(now), next_report_(now) {
  assert(settings.session != 0);
}

void PairProbe::on_datagram(HostTime at, Path path, std::span<const std::byte> datagram) {
  const auto message = decode_pair_message(datagram);
  if (!message || message->path != path || message->session == settings_.session || ended_) return;
  if (message->session != other_) {
    if (met_at_ && at - last_heard_ < kSilence) return;
    meet(message->session, at);
  }
  note(*message, path, datagram.size());
  measure_time(*message, at);
  last_heard_ = at;
  last_sent_ = message->sent;
}

// All that is known of a former session of the other side is void.
void PairProbe::meet(std::uint64_t other, HostTime at) {
  other_ = other;
  met_at_ = at;
  received_ = {};
  sent_stream_ = sent_lengths_ = 0;
  connected_ = false;
  both_complete_at_.reset();
  result_ = {};
  result_.answered = true;
}

void PairProbe::note(const PairMessage& m, Path path, std::size_t size_bytes) {
  Heard& heard = path == Path::kUnicast ? result_.unicast_in : result_.multicast_in;
  heard.any = true;
  heard.largest_bytes = std::max(heard.largest_bytes, static_cast<std::uint16_t>(size_bytes));
  auto& stream = received_[index_of(path)];
  if (m.in_stream != 0) stream.set(m.in_stream - 1u);
  heard.stream = static_cast<std::uint16_t>(stream.count());
  other_tcp_port_ = m.tcp_port;
  result_.complete |= m.complete;
  if (m.other != settings_.session) return;  // what it says is of nobody, or of a former run here
  result_.is_heard = true;
  // Datagrams may overtake each other; what was received stays so.
  const auto grow = [](Heard& known, const Heard& said) {
    known = {known.any || said.any, std::max(known.stream, said.stream),
             std::max(known.largest_bytes, said.largest_bytes)};
  };
  grow(result_.unicast_out, m.unicast);
  grow(result_.multicast_out, m.multicast);
  if (m.tcp != TcpState::kUntried) result_.tcp_in = m.tcp;
}

// The four times of NTP (RFC 5905, 8): offset = ((t2 - t1) + (t3 - t4)) / 2, delay = (t4 - t1) - (t3 - t2), of the
// exchange with the shortest delay.
void PairProbe::measure_time(const PairMessage& m, HostTime at) {
  if (m.other != settings_.session || m.echo_sent == HostTime{}) return;
  const HostTime t1 = m.echo_sent, t3 = m.sent, t2 = t3 - m.echo_held;
  const Duration delay = (at - t1) - m.echo_held;
  if (t1 < started_ || t1 > at || delay < Duration{0} || delay > kRoundTripMost) return;
  if (result_.round_trip && *result_.round_trip <= delay) return;
  result_.round_trip = delay;
  // The two differences may each be decades where a clock is wrong; their halves do not overflow.
  result_.clock_ahead = (t2 - t1) / 2 + (t3 - at) / 2;
}

void PairProbe::on_tick(HostTime now) {
  if (ended_) return;
  if (now >= next_report_) {
    send_both(now, kPairMessage_bytes, 0);
    next_report_ = now + kReportsApart;
  }
  if (met_at_) {
    send_due_stream(now);
    send_due_lengths(now);
    if (!connected_ && other_tcp_port_ != 0) {
      connected_ = true;
      outputs_.push_back(Connect{other_tcp_port_});
    }
  }
  check_end(now);
}

void PairProbe::send_due_stream(HostTime now) {
  const HostTime begin = *met_at_ + kStreamAfter;
  while (sent_stream_ < kStream && now >= begin + static_cast<int>(sent_stream_) * kStreamApart) {
    ++sent_stream_;
    send_both(now, kStream_bytes, static_cast<std::uint16_t>(sent_stream_));
  }
}

void PairProbe::send_due_lengths(HostTime now) {
  const HostTime begin = *met_at_ + kStreamAfter + static_cast<int>(kStream) * kStreamApart;
  while (sent_lengths_ < kEach * kLengths_bytes.size() &&
         now >= begin + static_cast<int>(sent_lengths_) * kLengthsApart) {
    const std::size_t length = kLengths_bytes[sent_lengths_ / kEach];
    ++sent_lengths_;
    send(now, Path::kUnicast, length, 0);
    if (length <= kMulticastMost_bytes) send(now, Path::kMulticast, length, 0);
  }
}

bool PairProbe::complete() const { return sent_stream_ == kStream && sent_lengths_ == kEach * kLengths_bytes.size(); }

void PairProbe::check_end(HostTime now) {
  if (!met_at_) {
    ended_ = now >= started_ + settings_.wait;
    return;
  }
  if (complete() && result_.complete && !both_complete_at_) both_complete_at_ = now;
  ended_ = now >= *met_at_ + kMost || (both_complete_at_ && now >= *both_complete_at_ + kLinger);
}

void PairProbe::send_both(HostTime now, std::size_t size_bytes, std::uint16_t in_stream) {
  send(now, Path::kUnicast, size_bytes, in_stream);
  send(now, Path::kMulticast, size_bytes, in_stream);
}

void PairProbe::send(HostTime now, Path path, std::size_t size_bytes, std::uint16_t in_stream) {
  if (path == Path::kMulticast && !settings_.multicast) return;
  PairMessage m;
  m.path = path;
  m.session = settings_.session;
  m.other = other_;
  m.sent = now;
  if (met_at_) {
    m.echo_sent = last_sent_;
    m.echo_held = std::max(Duration{0}, now - last_heard_);
  }
  m.in_stream = in_stream;
  m.tcp_port = settings_.tcp_port;
  m.tcp = result_.tcp_out;
  m.complete = complete();
  m.unicast = result_.unicast_in;
  m.multicast = result_.multicast_in;
  outputs_.push_back(Send{path, encode(m, size_bytes)});
}

std::vector<PairProbe::Output> PairProbe::take_outputs() { return std::exchange(outputs_, {}); }

HostTime PairProbe::next_deadline() const {
  HostTime next = met_at_ ? *met_at_ + kMost : std::min(next_report_, started_ + settings_.wait);
  next = std::min(next, next_report_);
  if (met_at_ && sent_stream_ < kStream) {
    next = std::min(next, *met_at_ + kStreamAfter + static_cast<int>(sent_stream_) * kStreamApart);
  } else if (met_at_ && !complete()) {
    next = std::min(next, *met_at_ + kStreamAfter + static_cast<int>(kStream) * kStreamApart +
                              static_cast<int>(sent_lengths_) * kLengthsApart);
  }
  if (both_complete_at_) next = std::min(next, *both_complete_at_ + kLinger);
  return next;
}

}  // namespace peerd::doctor
