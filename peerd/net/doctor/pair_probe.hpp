#pragma once
#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "peerd/net/doctor/pair_message.hpp"

namespace peerd::doctor {

// The result of trying the ways between this computer and another one.
struct PairResult {
  bool answered = false;             // something of it has arrived here
  bool is_heard = false;             // it says that something of this computer has arrived there
  bool complete = false;             // it has sent all that it tries
  Heard unicast_in, multicast_in;    // from there, as it arrived here
  Heard unicast_out, multicast_out;  // from here, as the other computer says
  TcpState tcp_out = TcpState::kUntried, tcp_in = TcpState::kUntried;
  std::optional<Duration> round_trip;  // the shortest of all
  Duration clock_ahead{0};             // of the other computer's, known to half of the round trip
};

// One side of `peerd doctor --with`: sans-IO. Both sides report to each other all the time what they have received. As
// soon as a side receives something of the other it sends a stream, by which loss is measured, and datagrams of several
// lengths. It sends by its own schedule only, whatever arrives.
class PairProbe {
 public:
  struct Send {
    Path path;
    std::vector<std::byte> datagram;
  };
  struct Connect {  // to this TCP port of the other computer
    std::uint16_t port;
  };
  using Output = std::variant<Send, Connect>;

  struct Settings {
    std::uint64_t session = 0;   // random, not 0
    std::uint16_t tcp_port = 0;  // at which this side listens; 0: none
    bool multicast = true;       // whether it can be sent
    Duration wait{0};            // for the other side to start
  };
  PairProbe(const Settings& settings, HostTime now);

  // A datagram from the other computer, which the caller tells from those of others by its address.
  void on_datagram(HostTime at, Path path, std::span<const std::byte> datagram);
  void on_tcp(TcpState state) { result_.tcp_out = state; }
  void on_tick(HostTime now);
  [[nodiscard]] std::vector<Output> take_outputs();  // in their order; to be called after on_tick()
  [[nodiscard]] HostTime next_deadline() const;

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool met() const { return met_at_.has_value(); }
  // The session of the other side; 0: none yet.
  [[nodiscard]] std::uint64_t other() const { return other_; }
  [[nodiscard]] const PairResult& result() const { return result_; }

 private:
  void meet(std::uint64_t other, HostTime at);
  void note(const PairMessage& message, Path path, std::size_t size_bytes);
  void measure_time(const PairMessage& message, HostTime at);
  void send(HostTime now, Path path, std::size_t size_bytes, std::uint16_t in_stream);
  void send_both(HostTime now, std::size_t size_bytes, std::uint16_t in_stream);
  void send_due_stream(HostTime now);
  void send_due_lengths(HostTime now);
  void check_end(HostTime now);
  [[nodiscard]] bool complete() const;

  Settings settings_;
  HostTime started_;
  HostTime next_report_;
  std::optional<HostTime> met_at_;  // when the session of the other side was first heard
  std::uint64_t other_ = 0;
  HostTime last_heard_{}, last_sent_{};  // of the other's last datagram: when it came, and its time of sending
  std::uint16_t other_tcp_port_ = 0;
  std::array<std::bitset<kStream>, 2> received_;  // of the other's stream, by path
  std::size_t sent_stream_ = 0, sent_lengths_ = 0;
  bool connected_ = false;
  std::optional<HostTime> both_complete_at_;
  bool ended_ = false;
  PairResult result_;
  std::vector<Output> outputs_;
};

}  // namespace peerd::doctor
