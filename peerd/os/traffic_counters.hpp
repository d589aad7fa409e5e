#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace peerd::net {

// What one transport has seen since it was opened. Bytes are UDP payload. Every datagram that reaches it ends in
// packets_in, greetings_in or one drop; so does every datagram that was given to send(), on the other side.
struct TrafficCounters {
  std::uint64_t packets_in = 0;  // handed to the receive handler
  std::uint64_t bytes_in = 0;
  std::uint64_t packets_out = 0;  // taken by the kernel; a datagram has no further receipt
  std::uint64_t bytes_out = 0;
  std::uint64_t calls_in = 0, calls_out = 0;  // system calls that read and sent them

  std::uint64_t in_truncated = 0;        // longer than kMaxDatagramBytes
  std::uint64_t in_other_group = 0;      // to a group that is not joined (or just left), or to this host alone
  std::uint64_t in_other_region = 0;     // of a region that is not joined, in a group that is, or by unicast
  std::uint64_t in_stranger = 0;         // by unicast, from where no known peer has echoed
  std::uint64_t in_other_interface = 0;  // a joined group, but over an interface that is not ours
  std::uint64_t in_no_destination = 0;   // the kernel did not say which group it was sent to
  std::uint64_t in_malformed = 0;        // does not say its region where it must
  std::uint64_t in_queue_overflow = 0;   // lost in the kernel: the receive buffer was full
  std::uint64_t in_errors = 0;           // failed reads, none of them a datagram
  // Of packets_in: how many have the time at which they were read, for want of a stamp of the kernel's, and because
  // the wall clock, which the kernel stamps by, was set while they waited.
  std::uint64_t in_unstamped = 0, in_stamp_refused = 0;

  std::uint64_t out_queue_full = 0;   // send buffer or interface queue full
  std::uint64_t out_unreachable = 0;  // interface down or gone, no route, no source address
  std::uint64_t out_blocked = 0;      // a firewall on this computer refused it
  std::uint64_t out_too_large = 0;    // longer than kMaxDatagramBytes
  std::uint64_t out_no_group = 0;     // the region lies past the end of the multicast range
  std::uint64_t out_errors = 0;

  // Of unicast alone: who is here (unicast_frame.hpp). Those that leave are in packets_out too.
  std::uint64_t greetings_in = 0, greetings_out = 0;
  std::uint64_t peers_refused = 0;  // greetings of one peer too many

  // By name ("net.packets_in"), for reports.
  [[nodiscard]] std::map<std::string, std::uint64_t> named() const;
};

}  // namespace peerd::net
