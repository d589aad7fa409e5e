#include "replication/session/admission.hpp"

#include <cassert>
#include <utility>

namespace peerd::replication {
namespace {

// The most versions that are reported.
constexpr std::size_t kVersionsMax = 8;
// The incarnations of so many departed peers are remembered, so that a late datagram of theirs is recognised.
constexpr std::size_t kDepartedMax = 4096;
// Questions whether this peer is alive are answered no more often, for each answer goes to all.
constexpr Duration kAnswersApart = std::chrono::milliseconds(50);
// Another program of this peer's id counts once it has been heard for so long, and not by one damaged datagram.
constexpr Duration kRivalGoesOnFor = std::chrono::milliseconds(50);

// Whether a datagram to all says nothing but that its sender is here.
bool says_presence_alone(RegionId region, const Message& m) {
  return region == kWholeScene && m.updates.empty() && m.decisions.empty() && m.scene.states.empty() &&
         m.operations.empty() && m.operation_requests.empty() && m.subscriptions.empty();
}

}  // namespace

Admission::Admission(const PeerConfig& config, Membership& members, Outbox& outbox, MemberLimits& limits)
    : config_(config),
      line_{config.log.line, false, config.log.is_of_a_session},
      members_(members),
      outbox_(outbox),
      limits_(limits) {}

void Admission::follow(bool has_edits, bool in_session) {
  assert(has_edits || !line_.has_edits);
  line_.has_edits = has_edits;
  line_.in_session = in_session || config_.log.is_of_a_session;
}

// A far hello, or another datagram to all of a peer that is no member of this one's large session.
std::expected<Membership::Admission, Drop> Admission::admit_far(HostTime now, const Message& m, const OnLost& on_lost) {
  assert(m.sender != config_.id);
  const Introduction* const introduction = m.introduction();
  const OtherPeer* const known = members_.find_any(m.sender);
  if (introduction == nullptr) {
    if (known == nullptr) return std::unexpected(Drop::kUnintroduced);
    if (incarnation_low(known->incarnation) != m.incarnation) return std::unexpected(Drop::kStaleIncarnation);
    return Membership::Admission::kFar;
  }
  const auto departed = departed_peers_.find(m.sender);
  const bool is_over = departed != departed_peers_.end() && m.incarnation <= departed->second;
  if (known == nullptr && is_over) return std::unexpected(Drop::kStaleIncarnation);
  if (known == nullptr && members_.count() >= kMembersMax) return std::unexpected(Drop::kTooMany);
  if (introduction->world_hash != config_.world_hash) return reject_other_world(m);
  if (known != nullptr && m.incarnation < known->incarnation) return std::unexpected(Drop::kStaleIncarnation);
  if (const auto same = check_line(m, on_lost); !same) return std::unexpected(same.error());
  if (known != nullptr && m.incarnation == known->incarnation) return Membership::Admission::kFar;
  if (!limits_.take(now, m.sender, MemberLimit::kRestarts)) return std::unexpected(Drop::kMemberLimit);
  if (const auto member = members_.remove(m.sender)) on_lost(m.sender, *member);
  if (const auto gone = members_.remove_far(m.sender)) on_lost(m.sender, *gone);
  return Membership::Admission::kFar;
}

std::expected<Membership::Admission, Drop> Admission::admit(HostTime now, RegionId region, const Message& m, bool leads,
                                                            std::optional<HostTime> started, const OnLost& on_lost) {
  if (m.sender == config_.id) return admit_own(now, m, started);
  const Introduction* introduction = m.introduction();
  if (m.next_hello) return admit_far(now, m, on_lost);
  const FarPeer* const far = members_.find_far(m.sender);
  const bool is_new = far == nullptr && members_.find(m.sender) == nullptr;
  const bool joins = m.hello && !m.hello->session_tx;  // the leader answers it
  if ((far != nullptr || is_new) && members_.is_large() && says_presence_alone(region, m) && !(leads && joins)) {
    return admit_far(now, m, on_lost);
  }
  const bool is_same_life =
      far != nullptr &&
      (introduction == nullptr ? incarnation_low(far->incarnation) == m.incarnation
                               : far->incarnation == m.incarnation && introduction->world_hash == config_.world_hash &&
                                     introduction->line == line_.line);
  if (is_same_life) {
    members_.promote(now, m.sender, true);
    return Membership::Admission::kNear;
  }
  const Member* known = members_.find(m.sender);
  if (introduction == nullptr) {
    if (known == nullptr) return std::unexpected(Drop::kUnintroduced);
    if (incarnation_low(known->incarnation) != m.incarnation) return std::unexpected(Drop::kStaleIncarnation);
    return members_.on_datagram(now, m.sender, known->incarnation);
  }
  // A datagram from before its goodbye, or the goodbye again.
  const auto departed = departed_peers_.find(m.sender);
  if (known == nullptr && departed != departed_peers_.end() && m.incarnation <= departed->second) {
    return std::unexpected(Drop::kStaleIncarnation);
  }
  if (known == nullptr && members_.count() >= kMembersMax) return std::unexpected(Drop::kTooMany);
  if (introduction->world_hash != config_.world_hash) {
    if (known != nullptr && m.incarnation < known->incarnation) return std::unexpected(Drop::kStaleIncarnation);
    if (const auto member = members_.remove(m.sender)) on_lost(m.sender, *member);
    return reject_other_world(m);
  }
  if (far != nullptr && m.incarnation < far->incarnation) return std::unexpected(Drop::kStaleIncarnation);
  if (known == nullptr || m.incarnation >= known->incarnation) {
    if (const auto same = check_line(m, on_lost); !same) return std::unexpected(same.error());
  }
  const bool starts = known == nullptr || m.incarnation > known->incarnation;
  if (starts && !limits_.take(now, m.sender, MemberLimit::kRestarts)) return std::unexpected(Drop::kMemberLimit);
  if (const auto gone = members_.remove_far(m.sender)) on_lost(m.sender, *gone);  // it begins anew
  const Membership::Admission admission = members_.on_datagram(now, m.sender, m.incarnation);
  if (admission == Membership::Admission::kStale) return reject_earlier_life(now, m);
  return admission;
}

// Long after a life has begun, no datagram of an earlier one is under way any more: it goes on.
std::unexpected<Drop> Admission::reject_earlier_life(HostTime now, const Message& m) {
  const Member* later = members_.find(m.sender);
  assert(later != nullptr);
  const bool goes_on = now - later->since >= config_.lost_after;
  if (goes_on && ids_in_use_.insert(m.sender).second) outbox_.push(IdInUse{m.sender, false, false});
  return std::unexpected(Drop::kStaleIncarnation);
}

Drop Admission::on_identity_check(HostTime now, const Message& m) {
  assert(m.identity);
  const IdentityCheck& check = *m.identity;
  if (m.sender != config_.id) return Drop::kIdentityCheck;
  if (check.answers || check.asker == config_.incarnation) return Drop::kOwn;
  const bool is_for_us = check.world_hash == config_.world_hash;
  if (!is_for_us || (answered_at_ && now - *answered_at_ < kAnswersApart)) return Drop::kIdentityCheck;
  answered_at_ = now;
  Message answer = outbox_.blank();
  answer.identity = IdentityCheck{check.asker, check.world_hash, true};
  outbox_.send_unnumbered(answer);
  return Drop::kIdentityCheck;
}

std::unexpected<Drop> Admission::admit_own(HostTime now, const Message& m, std::optional<HostTime> started) {
  const Introduction* introduction = m.introduction();
  const std::uint64_t own = introduction != nullptr ? config_.incarnation : incarnation_low(config_.incarnation);
  if (m.incarnation == own) return std::unexpected(Drop::kOwn);
  // Datagrams of this peer's last incarnation may still be under way.
  const bool just_started = !started || now - *started < config_.lost_after;
  if (just_started && (introduction == nullptr || m.incarnation < config_.incarnation)) {
    return std::unexpected(Drop::kStaleIncarnation);
  }
  if (introduction == nullptr)
    return std::unexpected(Drop::kIdInUse);  // unless it is in another world, which it does not say
  if (introduction->world_hash != config_.world_hash) return reject_other_world(m);
  if (rival_ != m.incarnation) {
    rival_ = m.incarnation;
    rival_heard_ = now;
  } else if (now - rival_heard_ >= kRivalGoesOnFor && ids_in_use_.insert(m.sender).second) {
    outbox_.push(IdInUse{m.sender, true, m.incarnation > config_.incarnation});
  }
  return std::unexpected(Drop::kIdInUse);
}

std::unexpected<Drop> Admission::reject_other_world(const Message& m) {
  assert(m.introduction() != nullptr);
  if (other_worlds_.size() == kMembersMax) other_worlds_.clear();
  if (other_worlds_.insert(m.sender).second) outbox_.push(OtherWorld{m.sender, m.introduction()->name});
  return std::unexpected(Drop::kOtherWorld);
}

// The message is the last word of its sender so far, which it introduces. The error is for one whose line is another,
// unless this peer takes that.
std::expected<void, Drop> Admission::check_line(const Message& m, const OnLost& on_lost) {
  assert(m.introduction() != nullptr && m.sender != config_.id);
  const Introduction& introduction = *m.introduction();
  const LineOfDescent other{introduction.line, introduction.has_edits, m.hello->session_tx.has_value()};
  const LineMeeting meeting = meet(line_, other);
  if (meeting == LineMeeting::kTake) {
    assert(!line_.has_edits);
    line_.line = other.line;
    outbox_.push(LineTaken{m.sender, other.line});
  }
  if (meeting == LineMeeting::kSame || meeting == LineMeeting::kTake) {
    other_lines_.erase(m.sender);
    return {};
  }
  if (const auto member = members_.remove(m.sender)) on_lost(m.sender, *member);
  if (const auto far = members_.remove_far(m.sender)) on_lost(m.sender, *far);
  if (other_lines_.size() == kMembersMax) other_lines_.clear();
  const auto [said, is_new] = other_lines_.try_emplace(m.sender);
  const bool is_news = std::exchange(said->second, other.line) != other.line || is_new;
  if (is_news && meeting != LineMeeting::kStay) {
    outbox_.push(OtherLine{m.sender, introduction.name, other.line, meeting == LineMeeting::kGoOver});
  }
  return std::unexpected(Drop::kOtherLine);
}

Member Admission::dismiss(PeerId peer) {
  auto member = members_.remove(peer);
  assert(member);
  note_departed(peer, member->incarnation);
  return *std::move(member);
}

void Admission::note_departed(PeerId peer, std::uint64_t incarnation) {
  if (departed_peers_.size() < kDepartedMax) departed_peers_[peer] = incarnation;
}

void Admission::on_other_version(PeerId sender, std::uint32_t version) {
  if (version == 0 || sender == kNobody || other_versions_.size() == kVersionsMax) return;
  if (other_versions_.insert(version).second) outbox_.push(OtherVersion{sender, version});
}

}  // namespace peerd::replication
