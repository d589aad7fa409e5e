#include "replication/session/membership.hpp"

#include <algorithm>
#include <cassert>

#include "replication/wire/codec.hpp"

namespace peerd::replication {

LossMeter Member::received_in_all() const {
  LossMeter all;
  for (const auto& [region, meter] : received) all += meter;
  return all;
}

Membership::Admission Membership::on_datagram(HostTime now, PeerId peer, std::uint64_t incarnation) {
  assert(peer != kNobody);
  const auto [at, added] = members_.try_emplace(peer);
  Member& member = at->second;
  Admission admission = added ? Admission::kJoined : Admission::kKnown;
  if (!added && incarnation < member.incarnation) return Admission::kStale;
  if (!added && incarnation > member.incarnation) {
    member = Member{};
    admission = Admission::kRestarted;
  }
  if (admission != Admission::kKnown) member.since = now;
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

void Membership::forget_clocks() {
  for (auto& [peer, member] : members_) member.clock = {};
}

double Membership::mean_loss() const {
  LossMeter all;
  for (const auto& [peer, member] : members_) all += member.received_in_all();
  return all.loss();
}

double Membership::worst_loss_to_peers() const {
  double worst = 0.0;
  for (const auto& [peer, member] : members_) {
    if (!member.echo.unreachable) worst = std::max(worst, member.echo.loss_to_peer.value_or(LossMeter{}.loss()));
  }
  assert(worst >= 0.0 && worst <= 1.0);
  return worst;
}

void Membership::reset_loss_of(RegionId region) {
  for (auto& [peer, member] : members_) member.received.erase(region);
}

Duration Membership::own_latency() const {
  Duration longest{0};
  for (const auto& [peer, member] : members_) longest = std::max(longest, member.delays.longest());
  return std::min<Duration>(latency_bound(longest), kLatencyMax);
}

Duration Membership::longest_latency() const {
  Duration longest = own_latency();
  for (const auto& [peer, member] : members_) longest = std::max(longest, member.latency);
  return longest;
}

Duration Membership::longest_mean_delay() const {
  Duration longest{0};
  for (const auto& [peer, member] : members_) longest = std::max(longest, member.delays.mean().value_or(Duration{0}));
  return longest;
}

}  // namespace peerd::replication
