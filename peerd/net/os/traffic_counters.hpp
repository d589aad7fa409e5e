#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace peerd::net {

// The counters of one transport since it was opened. Bytes are UDP payload. Every datagram that reaches the transport
// is counted once: in packets_in, greetings_in or one of the drops. Every datagram for send() is counted in packets_out
// or one of the drops.
struct TrafficCounters {
  std::uint64_t packets_in = 0;  // handed to the receive handler
  std::uint64_t bytes_in = 0;
  std::uint64_t packets_out = 0;  // taken by the kernel, which gives no further receipt
  std::uint64_t bytes_out = 0;
  std::uint64_t calls_in = 0, calls_out = 0;  // system calls that read and sent datagrams

  std::uint64_t in_truncated = 0;        // longer than kMaxDatagramBytes
  std::uint64_t in_other_group = 0;      // to a group that is not joined (or just left), or to this host alone
  std::uint64_t in_other_region = 0;     // of a region that is not joined, by a shared group or by unicast
  std::uint64_t in_stranger = 0;         // by unicast, from an address that has not echoed its number
  std::uint64_t in_other_interface = 0;  // to a joined group, but over another interface
  std::uint64_t in_no_destination = 0;   // the kernel did not name the destination group
  std::uint64_t in_malformed = 0;        // without a region header where one is required
  std::uint64_t in_queue_overflow = 0;   // lost in the kernel: the receive buffer was full
  std::uint64_t in_errors = 0;           // failed reads, which are not datagrams
  // The parts of packets_in that have the time of their reading, because the kernel gave no timestamp, or because the
  // wall clock, which the kernel stamps by, was set while they waited.
  std::uint64_t in_unstamped = 0, in_stamp_refused = 0;

  // A sealed transport alone has these (peerd/net/seal): announcements of peers' boots, and datagrams that were not
  // opened.
  std::uint64_t announcements_in = 0;
  std::uint64_t in_open = 0;            // not sealed
  std::uint64_t in_own = 0;             // with this peer's number, as those that come back to it
  std::uint64_t in_unproven = 0;        // of a boot that has not named this one's, or of a recorded session
  std::uint64_t in_forged = 0;          // of another key, damaged or forged
  std::uint64_t in_replayed = 0;        // for the second time, or too old
  std::uint64_t in_too_many_boots = 0;  // of a boot beyond those that are remembered
  std::uint64_t in_no_member = 0;       // announces a peer whose key is no member's
  std::uint64_t in_impostor = 0;        // announces a peer whose number is another key's
  std::uint64_t in_unsigned = 0;        // by somebody who has the session's key, and not by its sender
  std::uint64_t in_wrong_sender = 0;    // says another sender than it is sealed by
  std::uint64_t in_observer = 0;        // would change the world, by a member that may only look
  std::uint64_t in_other_epoch = 0;     // of another epoch: its sender has another roster, or none
  std::uint64_t in_flood = 0;           // of strangers, or signed, beyond what that may cost

  std::uint64_t out_queue_full = 0;   // send buffer or interface queue full
  std::uint64_t out_unreachable = 0;  // interface down or gone, no route, no source address
  std::uint64_t out_blocked = 0;      // a firewall on this computer refused it
  std::uint64_t out_stale = 0;        // waited too long for a server (peerd/net/nats)
  std::uint64_t out_too_large = 0;    // longer than kMaxDatagramBytes
  std::uint64_t out_no_group = 0;     // the region lies past the end of the multicast range
  std::uint64_t out_errors = 0;
  // Through a relay (peerd/net/relay): to a region that nobody behind it wants, and how often it was another one or
  // none.
  std::uint64_t out_unwanted = 0, relay_changes = 0;

  // Greetings are of unicast alone (unicast_frame.hpp). Greetings that leave are in packets_out, too.
  std::uint64_t greetings_in = 0, greetings_out = 0;
  std::uint64_t peers_refused = 0;  // greetings of peers beyond the limit of known peers
  // That the session's key does not open, and those of strangers beyond what they may cost.
  std::uint64_t greetings_unopened = 0, greetings_flood = 0;

  // The counters by name ("net.packets_in"), for reports.
  [[nodiscard]] std::map<std::string, std::uint64_t> named() const;
};

}  // namespace peerd::net
