#include "peerd/net/doctor/host_findings.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace peerd::doctor {
namespace {

// Docker and Podman put a container behind a bridge of its host, which forwards no multicast to the host's network,
// unless they are asked for another network. Other managers often bridge it to that network.
Finding container_of(const HostFacts& facts, const Examined& examined) {
  const auto used = links_used(facts, examined);
  const bool behind_host = std::ranges::any_of(used, &Link::other_end_elsewhere);
  const bool cut_off = behind_host && (facts.container == "docker" || facts.container == "podman");
  if (!cut_off || examined.with_another) {
    return {"container", Level::kHint, fmt::format("this is a container ({})", facts.container),
            "its host decides what reaches it: --network host has no such limits"};
  }
  if (examined.transport == Examined::Transport::kUnicast) {
    return {"container", Level::kHint,
            fmt::format("this is a container ({}) behind a bridge of its host: others reach it by published ports only",
                        facts.container),
            fmt::format("publish them (-p {0}:{0}/udp), or use --network host", examined.port)};
  }
  return {"container", Level::kWarning,
          fmt::format(
              "this is a container ({}) behind a bridge of its host: multicast reaches containers of that host only",
              facts.container),
          "run it with --network host or a macvlan network, or use unicast (transport.peers) with published ports"};
}

std::string ports_of(const Examined& e) {
  std::string text = fmt::format("let UDP {}", e.port);
  if (e.discovery_port != 0) text += fmt::format(" and {} (peerd ls)", e.discovery_port);
  if (e.transport == Examined::Transport::kMulticast) text += ", and IGMP,";
  if (e.snapshot_port != 0) return text + fmt::format(" in, and TCP {} for who joins", e.snapshot_port);
  return text + " in; for who joins TCP at a port that transport.snapshot_port sets";
}

Finding firewall_of(const Firewall& firewall, const Examined& examined) {
  if (!firewall.dropping.empty()) {
    return {"firewall", Level::kHint,
            fmt::format("what its rules do not accept is dropped here ({}); the rules themselves were not read",
                        names_of(firewall.dropping)),
            ports_of(examined)};
  }
  if (!firewall.readable) {
    return {"firewall", Level::kHint, "its rules were not read, which only root may", ports_of(examined)};
  }
  if (firewall.older_tables) {
    return {"firewall", Level::kHint, "there are rules of iptables-legacy, which were not read", ports_of(examined)};
  }
  return {"firewall", Level::kGood, "no chain of nftables drops by its policy what arrives here"};
}

}  // namespace

std::vector<Finding> place_findings(const HostFacts& facts, const Examined& examined) {
  std::vector<Finding> all;
  if (!facts.container.empty()) all.push_back(container_of(facts, examined));
  all.push_back(firewall_of(facts.firewall, examined));
  return all;
}

}  // namespace peerd::doctor
