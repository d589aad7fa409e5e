#include "peerd/daemon/loop/troubles.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace peerd {
namespace {

// A peer that is new has the time to hear this one, which says hello several times a second until then.
constexpr Duration kHeardWithin = std::chrono::milliseconds(1750);

}  // namespace

// In a large session hellos name others in long turns, and nothing is known so soon.
std::vector<std::string> one_way_links(const replication::Membership& members, HostTime now) {
  std::vector<std::string> all;
  if (members.is_large() || members.hellos_in_a_turn() > 1) return all;
  for (const auto& [id, member] : members.all()) {
    if (member.hello == 0 || member.echo.echoes_us || now - member.since < kHeardWithin) continue;
    if (member.echo.hellos_without_echo == 0) continue;
    all.push_back(fmt::format(
        "hears peer {} (id {}), which hears nothing of this one: a firewall there, or a network that carries datagrams "
        "one way; peerd doctor --with HOST, on both computers, says more",
        member.name, id.value));
  }
  return all;
}

std::string only_here(const std::string& why) {
  return why.empty() ? "" : "reaches this computer only, over " + why + "; peerd doctor says more";
}

std::string nothing_heard(const std::string& provider) {
  return "got its world from " + provider +
         " by TCP, and hears no datagram of any peer: a firewall here, or a network that doesn't carry them; peerd "
         "doctor --with HOST, on both computers, says more";
}

std::vector<std::string> SaidTroubles::due(HostTime now, const std::vector<std::string>& present) {
  std::erase_if(said_, [&](const auto& each) { return std::ranges::find(present, each.first) == present.end(); });
  std::vector<std::string> due;
  for (const std::string& trouble : present) {
    const auto said = said_.find(trouble);
    if (said != said_.end() && now - said->second < kAgainAfter) continue;
    said_[trouble] = now;
    due.push_back(trouble);
  }
  return due;
}

}  // namespace peerd
