#include "peerd/net/doctor/host_findings.hpp"

#include <spdlog/fmt/fmt.h>

namespace peerd::doctor {
namespace {

// The kernel's defaults. With less, peers of scenes with many regions open more sockets, and each costs a system call.
constexpr std::size_t kMemberships = 20;
constexpr std::size_t kOptmem_bytes = 20480;

Finding clock_of(const std::optional<Duration>& error) {
  if (error) {
    return {"clock", Level::kGood,
            fmt::format("steered, and within {:.3g} ms of UTC as the kernel says", to_seconds(*error) * 1e3)};
  }
  return {"clock", Level::kHint,
          "nothing steers this computer's clock: peers find session time by themselves, but instants in logs and "
          "recordings "
          "of several computers cannot be compared",
          "run an NTP client, such as chrony"};
}

}  // namespace

std::vector<Finding> limit_findings(const HostFacts& facts, const Examined& examined) {
  std::vector<Finding> all;
  const bool multicast = examined.transport == Examined::Transport::kMulticast;
  if (multicast && !examined.ipv6 && facts.memberships_max && *facts.memberships_max < kMemberships) {
    all.push_back(
        {"memberships", Level::kHint,
         fmt::format("a socket joins {} groups at most: a peer opens a socket for each such number of regions",
                     *facts.memberships_max),
         fmt::format("sysctl -w net.ipv4.igmp_max_memberships={}, or transport.group_pool", kMemberships)});
  }
  if (multicast && examined.ipv6 && facts.optmem_bytes && *facts.optmem_bytes < kOptmem_bytes) {
    all.push_back({"memberships", Level::kHint,
                   fmt::format("a socket has {} bytes for its IPv6 groups: a peer opens more sockets for its regions",
                               *facts.optmem_bytes),
                   fmt::format("sysctl -w net.core.optmem_max={}, or transport.group_pool", kOptmem_bytes)});
  }
  if (facts.taken.discovery != 0) {
    all.push_back(
        {"port", Level::kWarning,
         fmt::format("UDP port {} is held by a program that does not share it: peerd ls and peerd join will not "
                     "find a peer here",
                     facts.taken.discovery),
         fmt::format("stop it (ss -ulnp \"sport = :{}\" names it)", facts.taken.discovery)});
  }
  if (facts.taken.snapshot != 0) {
    all.push_back(
        {"port", Level::kHint,
         fmt::format("TCP port {} (transport.snapshot_port) is in use, by a peer that runs or another program",
                     facts.taken.snapshot),
         fmt::format("ss -tlnp \"sport = :{}\" names it", facts.taken.snapshot)});
  }
  all.push_back(clock_of(facts.clock_error));
  return all;
}

}  // namespace peerd::doctor
