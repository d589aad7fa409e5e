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
  if (added) far_.erase(peer);
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

std::vector<std::pair<PeerId, Member>> Membership::expire(HostTime now, const std::function<bool(PeerId)>& is_due,
                                                          std::optional<PeerId> followed, std::vector<PeerId>* far) {
  std::vector<std::pair<PeerId, Member>> lost;
  for (auto at = members_.begin(); at != members_.end();) {
    const PeerId peer = at->first;
    const Member& member = at->second;
    if (now - member.last_received < lost_after_) {
      ++at;
      continue;
    }
    const HostTime expected_until = far_hello_until(member);
    const bool is_expected = expected_until > now, is_to_be_heard = member.is_near && is_due && is_due(peer);
    if (is_expected && !is_to_be_heard && (peer == followed || peer == lowest())) {
      at->second.is_near = false;
      ++at;
      continue;
    }
    if (is_expected && !is_to_be_heard) {
      assert(!far_.contains(peer));
      OtherPeer& gone = far_[peer];
      gone = std::move(at->second);
      gone.expected_until = expected_until;
      if (far != nullptr) far->push_back(peer);
      at = members_.erase(at);
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
  for (auto& [peer, member] : members_) {
    member.expected_until += std::max(Duration{0}, now - member.last_received);
    member.last_received = now;
  }
  const Duration silent = far_checked_at_ == HostTime{} ? Duration{0} : now - far_checked_at_;
  for (auto& [peer, far] : far_) far.expected_until += silent;
  far_checked_at_ = now;
}

FarPeer* Membership::find_far(PeerId peer) {
  const auto at = far_.find(peer);
  return at == far_.end() ? nullptr : &at->second;
}

std::pair<FarPeer*, bool> Membership::note_far(HostTime now, PeerId peer, std::uint64_t incarnation) {
  assert(!members_.contains(peer));
  const auto [at, is_new] = far_.try_emplace(peer);
  if (is_new) at->second.since = now;
  at->second.incarnation = incarnation;
  return {&at->second, is_new};
}

std::optional<FarPeer> Membership::remove_far(PeerId peer) {
  auto node = far_.extract(peer);
  if (node.empty()) return std::nullopt;
  return std::move(node.mapped());
}

PeerId Membership::far_owner(ObjectId object) const {
  const auto at = std::ranges::find_if(
      far_, [&](const auto& each) { return std::ranges::binary_search(each.second.owned, object); });
  return at == far_.end() ? kNobody : at->first;
}

const OtherPeer* Membership::find_any(PeerId peer) const {
  if (const auto member = members_.find(peer); member != members_.end()) return &member->second;
  const auto far = far_.find(peer);
  return far == far_.end() ? nullptr : &far->second;
}

void Membership::for_each(const std::function<void(PeerId, OtherPeer&)>& function) {
  for (auto& [peer, member] : members_) function(peer, member);
  for (auto& [peer, far] : far_) function(peer, far);
}

std::pair<PeerId, const OtherPeer*> Membership::lowest_that(const std::function<bool(const OtherPeer&)>& is_so) const {
  std::pair<PeerId, const OtherPeer*> lowest{kNobody, nullptr};
  const auto look_in = [&](const auto& peers) {
    for (const auto& [peer, each] : peers) {
      if (lowest.second != nullptr && lowest.first < peer) return;
      if (is_so(each)) {
        lowest = {peer, &each};
        return;
      }
    }
  };
  look_in(members_);
  look_in(far_);
  return lowest;
}

// More peers may have come since the last far hello, so that the next one may come later than it promised.
HostTime Membership::far_hello_until(const OtherPeer& peer) const {
  return peer.promises_hellos ? std::max(peer.expected_until, peer.far_hello.rx + far_patience()) : peer.expected_until;
}

// The far hellos of the leader come all the time. A peer that says what is `nearby` says far hellos, too, and this peer
// may not have been here yet for the last one.
HostTime Membership::far_hello_until(const Member& member) const {
  if (member.leads) return member.expected_until;
  const HostTime until = far_hello_until(static_cast<const OtherPeer&>(member));
  return member.received_on(kNearby) == nullptr ? until : std::max(until, member.last_received + far_patience());
}

Duration Membership::mean_far_interval() const {
  assert(large_.hellos_per_s > 0.0);
  return from_seconds(static_cast<double>(count() + 1) / large_.hellos_per_s);
}

Duration Membership::far_patience() const { return kFarHellosMissed * 2 * mean_far_interval() + lost_after_; }

std::optional<SimTime> Membership::announced_start() const {
  const OtherPeer* const announces = lowest_that([](const OtherPeer& each) { return each.start.has_value(); }).second;
  return announces == nullptr ? std::nullopt : announces->start;
}

bool Membership::has_joining(HostTime now) const {
  return lowest_that([&](const OtherPeer& each) {
           return !each.synchronised && now - each.far_hello.rx < lost_after_;
         }).second != nullptr;
}

Member& Membership::promote(HostTime now, PeerId peer, bool is_near) {
  auto node = far_.extract(peer);
  assert(!node.empty());
  assert(!members_.contains(peer));
  Member& member = members_[peer];
  static_cast<OtherPeer&>(member) = std::move(node.mapped());
  member.last_received = member.echoing = now;
  member.is_near = is_near;
  return member;
}

std::optional<PeerId> Membership::lowest() const {
  const auto [peer, lowest] = lowest_that([](const OtherPeer& each) { return each.synchronised; });
  return lowest == nullptr ? std::nullopt : std::optional(peer);
}

std::vector<std::pair<PeerId, FarPeer>> Membership::expire_far(HostTime now) {
  std::vector<std::pair<PeerId, FarPeer>> lost;
  if (now - far_checked_at_ < std::chrono::seconds(1)) return lost;
  far_checked_at_ = now;
  for (auto at = far_.begin(); at != far_.end();) {
    if (far_hello_until(at->second) > now) {
      ++at;
      continue;
    }
    lost.emplace_back(at->first, std::move(at->second));
    at = far_.erase(at);
  }
  return lost;
}

bool Membership::follow_size(bool may_be) {
  const std::size_t all = count() + 1;
  const bool was = is_large_;
  // Two peers echo each other only if both take the session for large, or neither: a joining peer does as the others do
  // already.
  const auto is_so_for_others = [this] {
    return !far_.empty() ||
           std::ranges::any_of(members_, [](const auto& each) { return each.second.echoes_on == kNearby; });
  };
  is_large_ = may_be && large_.above > 0 &&
              (all > large_.above || (4 * all > std::size_t{3} * large_.above && (was || is_so_for_others())));
  return is_large_ != was;
}

Member* Membership::find(PeerId peer) {
  const auto at = members_.find(peer);
  return at == members_.end() ? nullptr : &at->second;
}

std::optional<HostTime> Membership::next_expiry() const {
  if (members_.empty()) return std::nullopt;
  std::optional<HostTime> first;
  for (const auto& [peer, member] : members_) {
    const HostTime at =
        std::max(member.last_received + lost_after_, member.is_near ? HostTime{} : far_hello_until(member));
    if (!first || at < *first) first = at;
  }
  return first;
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
    if (member.echo.unreachable) continue;
    // In a large session nobody sends more often because a peer that does not echo it has come near.
    if (is_large_ && !member.echo.loss_to_peer) continue;
    worst = std::max(worst, member.echo.loss_to_peer.value_or(LossMeter{}.loss()));
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
