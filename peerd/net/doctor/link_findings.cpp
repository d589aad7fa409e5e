#include "peerd/net/doctor/host_findings.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/os/datagram_limits.hpp"

namespace peerd::doctor {
namespace {

constexpr unsigned kDatagram_bytes = net::kSentDatagramMax_bytes;
constexpr unsigned kIpv4AndUdp_bytes = 28, kIpv6AndUdp_bytes = 48;

Finding mtu_of(const Link& link, bool ipv6) {
  const unsigned needed = kDatagram_bytes + (ipv6 ? kIpv6AndUdp_bytes : kIpv4AndUdp_bytes);
  if (link.mtu_bytes >= needed) {
    return {"mtu", Level::kGood,
            fmt::format("{} takes the longest datagrams whole (MTU {})", link.name, link.mtu_bytes)};
  }
  return {
      "mtu", Level::kWarning,
      fmt::format("{} cuts datagrams of {} bytes into fragments, and loses them where one of these is lost (MTU {})",
                  link.name, kDatagram_bytes, link.mtu_bytes),
      fmt::format("ip link set {} mtu {} or more, on all computers of its network", link.name, needed)};
}

bool forgets_groups(const Link& bridge) {
  return bridge.kind == "bridge" && bridge.up && bridge.snooping && !bridge.querier && !bridge.querier_elsewhere;
}

// A bridge that hears no querier forgets after 260 s which ports are in a group: twice the interval of queries, 125 s,
// and the time for answers, 10 s (RFC 3376, 8.4).
Finding snooping_of(const Link& bridge, bool is_used) {
  return {
      "snooping", is_used ? Level::kWarning : Level::kHint,
      fmt::format("bridge {} forwards multicast to the ports alone that have asked for it (snooping), and nobody asks "
                  "them again (no querier): after some 4 minutes peers behind it may not be heard any more",
                  bridge.name),
      fmt::format("ip link set {0} type bridge mcast_querier 1, or mcast_snooping 0", bridge.name)};
}

// A sender of another subnet of the same network is one such source.
Finding sources_of(const Link& link, std::size_t dropped) {
  return {
      "rp_filter", dropped > 0 ? Level::kWarning : Level::kHint,
      fmt::format("{} drops multicast of peers whose subnet this computer would answer over another interface, or "
                  "not at all (rp_filter is 1){}",
                  link.name, dropped > 0 ? fmt::format("; {} packets have been dropped so", dropped) : ""),
      fmt::format("where peers have addresses of several subnets: sysctl -w net.ipv4.conf.{}.rp_filter=2", link.name)};
}

}  // namespace

std::vector<Finding> link_findings(const HostFacts& facts, const Examined& examined) {
  std::vector<Finding> all;
  const auto used = links_used(facts, examined);
  for (const Link* link : used) {
    all.push_back(mtu_of(*link, examined.ipv6));
    const bool by_ipv4_group = examined.transport == Examined::Transport::kMulticast && !examined.ipv6;
    if (link->strict_sources && by_ipv4_group) all.push_back(sources_of(*link, facts.dropped_by_source));
    if (link->wireless && examined.transport == Examined::Transport::kMulticast) {
      all.push_back({"wireless", Level::kHint,
                     fmt::format("{} is wireless: access points send multicast slowly, and never again when it is lost",
                                 link->name),
                     "with few peers unicast does better: --set transport.multicast=never, and transport.peers"});
    }
  }
  if (examined.transport != Examined::Transport::kMulticast) return all;
  for (const Link& bridge : facts.links) {
    if (!forgets_groups(bridge)) continue;
    const bool is_used = std::ranges::any_of(
        used, [&](const Link* link) { return link->index == bridge.index || link->bridge_index == bridge.index; });
    all.push_back(snooping_of(bridge, is_used));
  }
  return all;
}

}  // namespace peerd::doctor
