#include "replication/session/membership.hpp"

#include <algorithm>

namespace peerd::replication {

void Acknowledgement::on_echo(const Echo& echo) {
  if (echo.received.highest >= received.highest) received = echo.received;  // else overtaken by a later one
}

Membership::Admission Membership::on_datagram(HostTime now, PeerId peer, std::uint64_t incarnation) {
  const auto [at, added] = members_.try_emplace(peer);
  Member& member = at->second;
  Admission admission = added ? Admission::kJoined : Admission::kKnown;
  if (!added && incarnation < member.incarnation) return Admission::kStale;
  if (!added && incarnation > member.incarnation) {
    member = Member{};
    admission = Admission::kRestarted;
  }
  member.incarnation = incarnation;
  member.last_received = now;
  return admission;
}

std::vector<std::pair<PeerId, Member>> Membership::expire(HostTime now) {
  std::vector<std::pair<PeerId, Member>> lost;
  for (auto at = members_.begin(); at != members_.end();) {
    if (now - at->second.last_received < lost_after_) {
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

void Membership::restart_silence_of_all(HostTime now) {
  for (auto& [peer, member] : members_) member.last_received = now;
}

Member* Membership::find(PeerId peer) {
  const auto at = members_.find(peer);
  return at == members_.end() ? nullptr : &at->second;
}

std::optional<HostTime> Membership::next_expiry() const {
  if (members_.empty()) return std::nullopt;
  const auto first = std::ranges::min_element(members_, {}, [](const auto& e) { return e.second.last_received; });
  return first->second.last_received + lost_after_;
}

}  // namespace peerd::replication
