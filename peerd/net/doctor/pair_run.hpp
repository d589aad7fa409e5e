#pragma once
#include <expected>
#include <functional>
#include <string>

#include "peerd/net/doctor/pair_probe.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/transport/open_transport.hpp"

namespace peerd::doctor {

struct PairOptions {
  net::TransportOptions transport;  // as a peer has it
  std::uint16_t snapshot_port = 0;  // TCP, for joining peers; 0: the system chooses one
  std::string host;           // HOST or HOST:PORT of the other computer; the port is this one's where none is given
  Duration wait{0};           // for the other side to start
  std::uint64_t session = 0;  // random, not 0
  std::function<void(const std::string&)> say;  // what happens, for a person who waits
};

// The result, with all that a sentence about it needs.
struct PairOutcome {
  PairResult result;
  std::string host;                // without a port, as the user named it
  std::string host_address;        // "192.0.2.2:47474"
  std::string own_address;         // the same of this computer, as the other would name it
  std::string group;               // "239.192.80.0 port 47474"; empty: multicast was not tried
  std::string why_no_multicast;    // empty: it was tried
  bool multicast_wanted = true;    // false: transport.multicast is "never"
  std::string interface;           // over which multicast was tried
  bool interface_guessed = false;  // a peer with these settings would use lo
  std::string unicast_problem;     // the last refusal of the system to send; empty: none
  std::string tcp_problem;         // why no port listens; empty: one does
  std::uint16_t tcp_port = 0;
  Duration waited{0};  // until the end, where the other side did not answer
};

// Runs one side of the test until its end: at most `wait`, and 13 s more from the other side's first datagram on.
[[nodiscard]] std::expected<PairOutcome, net::NetError> run_pair(const net::HostClock& clock,
                                                                 const PairOptions& options);

}  // namespace peerd::doctor
