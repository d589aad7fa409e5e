#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "peerd/net/doctor/finding.hpp"
#include "peerd/net/doctor/host_facts.hpp"

namespace peerd::doctor {

// The trial of a peer's settings on this computer.
struct Examined {
  enum class Transport : std::uint8_t { kNone, kMulticast, kUnicast } transport = Transport::kNone;
  std::string problem = {};        // of kNone: why a peer could not run
  std::string interface = {};      // of kMulticast
  std::string why_interface = {};  // "lo, as configured"
  bool ipv6 = false;
  int ttl = 1;                       // of multicast [hops]
  std::uint16_t port = 0;            // UDP
  std::uint16_t discovery_port = 0;  // UDP; 0: not discoverable
  std::uint16_t snapshot_port = 0;   // TCP, for joining peers; 0: the system chooses one
  bool with_another = false;  // another computer is tried, too: what is seen there counts, not what is guessed here
};

// Evaluates the facts: pure functions, which read nothing.
[[nodiscard]] std::vector<Finding> host_findings(const HostFacts& facts, const Examined& examined);

// The parts of host_findings(). This one says whom a peer would reach.
[[nodiscard]] std::vector<Finding> reach_findings(const HostFacts& facts, const Examined& examined);
// Findings about the interfaces that a peer would use, and about bridges.
[[nodiscard]] std::vector<Finding> link_findings(const HostFacts& facts, const Examined& examined);
// Findings about the limits of the kernel and the clock.
[[nodiscard]] std::vector<Finding> limit_findings(const HostFacts& facts, const Examined& examined);
// Findings about containers and firewalls.
[[nodiscard]] std::vector<Finding> place_findings(const HostFacts& facts, const Examined& examined);

// The interfaces over which a peer would send to others.
[[nodiscard]] std::vector<const Link*> links_used(const HostFacts& facts, const Examined& examined);

// A comma-separated list of the elements' names.
[[nodiscard]] std::string names_of(const std::vector<std::string>& names);

}  // namespace peerd::doctor
