#include "replication/session/membership.hpp"

#include <algorithm>

namespace peerd::replication {

void Receipt::on_echo(const Echo& echo) {
  if (echo.received.highest >= received.highest) received = echo.received;  // else overtaken by a later one
}

Membership::Heard Membership::on_datagram(HostTime now, PeerId peer, std::uint64_t boot) {
  const auto [at, added] = members_.try_emplace(peer);
  Member& member = at->second;
  Heard heard = added ? Heard::kJoined : Heard::kKnown;
  if (!added && boot < member.boot) return Heard::kStale;
  if (!added && boot > member.boot) {
    member = Member{};
    heard = Heard::kRestarted;
  }
  member.boot = boot;
  member.last_heard = now;
  return heard;
}

std::vector<std::pair<PeerId, Member>> Membership::expire(HostTime now) {
  std::vector<std::pair<PeerId, Member>> lost;
  for (auto at = members_.begin(); at != members_.end();) {
    if (now - at->second.last_heard < lost_after_) {
      ++at;
      continue;
    }
    lost.emplace_back(at->first, std::move(at->second));
    at = members_.erase(at);
  }
  return lost;
}

std::optional<Member> Membership::remove(PeerId peer) {
  auto node = members_.extract(peer);
  if (node.empty()) return std::nullopt;
  return std::move(node.mapped());
}

void Membership::excuse(HostTime now) {
  for (auto& [peer, member] : members_) member.last_heard = now;
}

Member* Membership::find(PeerId peer) {
  const auto at = members_.find(peer);
  return at == members_.end() ? nullptr : &at->second;
}

std::optional<HostTime> Membership::next_expiry() const {
  if (members_.empty()) return std::nullopt;
  const auto first = std::ranges::min_element(members_, {}, [](const auto& e) { return e.second.last_heard; });
  return first->second.last_heard + lost_after_;
}

}  // namespace peerd::replication
