#include "peerd/daemon/loop/troubles.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "replication/wire/operation.hpp"

namespace peerd {
namespace {

// A peer that is new has the time to hear this one, which says hello several times a second until then.
constexpr Duration kHeardWithin = std::chrono::milliseconds(1750);

std::string deaf(const std::string& peer) {
  return "hears " + peer +
         ", which hears nothing of this one: a firewall there, or a network that carries datagrams one way; peerd "
         "doctor --with HOST, on both computers, says more";
}

}  // namespace

// In a large session hellos name others in long turns, and nothing is known so soon.
std::vector<std::string> OneWayLinks::find(const replication::Membership& members, HostTime now) {
  if (asked_at_ && now - *asked_at_ > kStoppedAfter) unheard_since_.clear();
  asked_at_ = now;
  std::vector<std::string> all;
  std::map<PeerId, HostTime> unheard_since;
  if (members.is_large() || members.hellos_in_a_turn() > 1) return all;
  for (const auto& [id, member] : members.all()) {
    if (member.hello == 0 || member.echo.echoes_us || member.echo.hellos_without_echo == 0) continue;
    const auto known = unheard_since_.find(id);
    const HostTime since = known == unheard_since_.end() ? now : known->second;
    unheard_since.emplace(id, since);
    if (now - since < kHeardWithin) continue;
    all.push_back(deaf(fmt::format("peer {} (id {})", member.name, id.value)));
  }
  unheard_since_ = std::move(unheard_since);
  return all;
}

std::string one_way_link(PeerId peer) { return deaf(fmt::format("the peer of id {}", peer.value)); }

std::string edits_ahead(Duration ahead) {
  if (ahead <= replication::kStampAheadMax) return "";
  return "has edits whose stamps are ahead of the session's time, as a clock here or there is wrong: others see them, "
         "and new ones of this peer, only then; started again, it begins another log, and new edits take effect at "
         "once";
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
