#include "peerd/net/doctor/host_findings.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace peerd::doctor {
namespace {

constexpr const char* kName = "reach";

// How peers of several computers meet without multicast.
constexpr std::string_view kUnicastRecipe =
    "list the other computers' peers by HOST:PORT: --set 'transport.peers=[\"192.0.2.7:47474\"]'";

bool reaches_outwards(const Link& link) { return link.up && link.has_carrier && !link.loopback; }

std::string advice_for_others(const HostFacts& facts) {
  std::vector<std::string> names;
  for (const Link& link : facts.links) {
    if (reaches_outwards(link) && link.multicast) names.push_back(link.name);
  }
  if (names.empty()) return fmt::format("connect an interface with an address, or {}", kUnicastRecipe);
  return fmt::format("name the interface (--interface NAME: {}), or {}", names_of(names), kUnicastRecipe);
}

Finding by_multicast(const HostFacts& facts, const Examined& examined) {
  const auto link = std::ranges::find(facts.links, examined.interface, &Link::name);
  if (link == facts.links.end()) {
    return {kName, Level::kWarning, fmt::format("interface {} is gone by now", examined.interface), "try again"};
  }
  if (link->loopback) {
    return {kName, Level::kWarning,
            fmt::format("peers on other computers will not be heard: {}", examined.why_interface),
            advice_for_others(facts)};
  }
  if (!reaches_outwards(*link)) {
    return {kName, Level::kWarning,
            fmt::format("peers on other computers will not be heard: {} is not connected (no carrier)", link->name),
            fmt::format("connect it (a cable, a wireless network), or {}", kUnicastRecipe)};
  }
  if (examined.ttl == 0) {
    return {kName, Level::kWarning, "peers on other computers will not be heard: transport.ttl is 0",
            "set it to 1 for this network, or to more for networks behind multicast routers"};
  }
  if (examined.with_another) return {kName, Level::kGood, fmt::format("{} is connected", link->name)};
  return {
      kName, Level::kGood,
      fmt::format("{} is connected, and multicast over it comes back to this computer; whether another computer hears "
                  "it, only that one knows: run peerd doctor --with HOST on both",
                  link->name)};
}

Finding by_route(const HostFacts& facts, const Route& route) {
  if (route.way == Route::Way::kNone) {
    return {kName, Level::kWarning, fmt::format("there is no route to {}", route.peer),
            "connect an interface from which it is reached, or mend its address in the settings"};
  }
  if (route.way == Route::Way::kThisComputer) {
    return {kName, Level::kWarning, fmt::format("{} is this computer itself", route.peer),
            fmt::format("to reach others {}", kUnicastRecipe)};
  }
  const auto link = std::ranges::find(facts.links, route.interface, &Link::name);
  if (link != facts.links.end() && !reaches_outwards(*link)) {
    return {kName, Level::kWarning,
            fmt::format("{} is reached over {}, which is not connected", route.peer, link->name),
            "connect it (a cable, a wireless network)"};
  }
  return {
      kName, Level::kGood,
      fmt::format("there is a route to {}{}{}", route.peer, route.interface.empty() ? "" : " over ", route.interface)};
}

// Peers that list this one may greet it, but only where they can reach it.
Finding without_peers(const HostFacts& facts) {
  const bool connected = std::ranges::any_of(facts.links, reaches_outwards);
  return {kName, connected ? Level::kHint : Level::kWarning,
          connected ? "no peers are configured: those are heard that list this one"
                    : "no peers are configured, and no interface is connected over which others could reach this one",
          std::string(kUnicastRecipe)};
}

}  // namespace

std::vector<Finding> reach_findings(const HostFacts& facts, const Examined& examined) {
  switch (examined.transport) {
    case Examined::Transport::kNone:
      return {{kName, Level::kProblem, "a peer could not run: " + examined.problem}};
    case Examined::Transport::kMulticast:
      return {by_multicast(facts, examined)};
    case Examined::Transport::kUnicast:
      break;
  }
  if (facts.routes.empty()) return {without_peers(facts)};
  std::vector<Finding> all;
  for (const Route& route : facts.routes) all.push_back(by_route(facts, route));
  return all;
}

}  // namespace peerd::doctor
