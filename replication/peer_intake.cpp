// Peer: what comes in.
#include <algorithm>
#include <utility>

#include "replication/decision/decision.hpp"
#include "replication/peer.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// An owner that has not taken up a decision for so long has never heard it: what it says counts again.
constexpr Duration kDecisionStands = std::chrono::seconds(2);
// A decision may be of what happened up to 3 s ago (peer_decisions.cpp), told again where datagrams get lost.
constexpr Duration kDecisionAgeMax = std::chrono::seconds(6);
// More peers than one network carries: somebody invents them.
constexpr std::size_t kMembersMax = 4096;
// So many are told of.
constexpr std::size_t kVersionsMax = 8;
// Of so many that have left, what they sent before is known when it comes again.
constexpr std::size_t kDepartedPeersMax = 4096;

}  // namespace

std::expected<void, Drop> Peer::on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram) {
  const auto dropped = [&](Drop why) {
    if (why != Drop::kOwn) {  // what comes back by loopback is no news
      drop(to_string(why));
      ++counters_.regions[region].drops[to_string(why)];
    }
    return std::unexpected(why);
  };
  (void)detect_suspension(now);  // what comes is read by the time that goes on
  const auto message = codec_.decode(datagram, clock_.to_session(now));
  if (!message) {
    ++counters_.drops[std::string("undecodable_") + to_string(message.error())];  // which of them
    if (message.error() == DecodeError::kVersion) on_other_version();
    return dropped(Drop::kUndecodable);
  }
  Message& m = **message;
  const bool for_all = m.hello || m.leaving || !m.decisions.empty() || !m.subscriptions.empty();
  if (for_all && region != kWholeScene) return dropped(Drop::kRegion);
  if (const auto admitted = admit(now, m); !admitted) return dropped(admitted.error());
  ++counters_.datagrams_in;
  counters_.bytes_in += datagram.size();
  Counters::Traffic& traffic = counters_.regions[region];
  ++traffic.datagrams_in;
  traffic.bytes_in += datagram.size();
  Member& member = *members_.find(m.sender);
  ++member.datagrams_in;
  member.bytes_in += datagram.size();
  if (m.number > 0) member.received[region].on_datagram(m.number);
  if (m.hello) on_hello(now, m.sender, m.number, *m.hello);
  if (m.leaving) {
    const Member left = *members_.remove(m.sender);
    if (departed_peers_.size() < kDepartedPeersMax) departed_peers_[m.sender] = left.incarnation;
    lose_peer(m.sender, left.name, now, true);
    return {};
  }
  if (!replica_) {
    if (m.updates.empty() && m.decisions.empty()) return {};
    return dropped(Drop::kNotYetInSession);
  }
  if (m.unknown_models > 0) counters_.drops["unknown_model"] += m.unknown_models;
  const SimTime session_now = clock_.to_session(now);
  on_subscriptions(m.sender, m.subscriptions, session_now);
  on_handovers(m.sender, m.handovers, session_now);
  for (UpdateRecord& u : m.updates) {
    if (u.at < session_now - kUpdateAgeMax || u.at > session_now + kUpdateAheadMax) {
      drop(m.sender, "update_time");
    } else {
      on_update(m.sender, m.number, u, session_now);
    }
  }
  for (const DecisionRecord& d : m.decisions) {
    if (d.contact < session_now - kDecisionAgeMax || d.contact > session_now + kUpdateAheadMax) {
      drop(m.sender, "decision_time");
    } else {
      on_decision(m.sender, m.number, d, session_now);
    }
  }
  return {};
}

// Whether a sound message is one for us: of another peer, in its present life, with our world. What does not introduce
// its sender counts if that is known.
std::expected<void, Drop> Peer::admit(HostTime now, const Message& m) {
  const Introduction* introduction = m.introduction();
  if (m.sender == config_.id) {
    if (m.incarnation == (introduction != nullptr ? config_.incarnation : incarnation_low(config_.incarnation))) return std::unexpected(Drop::kOwn);
    // What this peer sent in its last life may still be under way.
    const bool just_started = !started_ || now - *started_ < config_.lost_after;
    if (just_started && (introduction == nullptr || m.incarnation < config_.incarnation)) return std::unexpected(Drop::kStaleIncarnation);
    if (introduction == nullptr) return std::unexpected(Drop::kIdInUse);  // if not in another world
    if (introduction->world_hash != config_.world_hash) return on_other_world(m);
    if (!std::exchange(id_in_use_reported_, true)) outputs_.push_back(IdInUse{m.sender});
    return std::unexpected(Drop::kIdInUse);
  }
  const Member* known = members_.find(m.sender);
  if (introduction == nullptr) {
    if (known == nullptr) {
      on_unintroduced_peer(now, m.sender);
      return std::unexpected(Drop::kUnintroduced);
    }
    if (incarnation_low(known->incarnation) != m.incarnation) return std::unexpected(Drop::kStaleIncarnation);
    members_.on_datagram(now, m.sender, known->incarnation);
    return {};
  }
  // What it said before its goodbye, or that again.
  if (const auto left = departed_peers_.find(m.sender); known == nullptr && left != departed_peers_.end() && m.incarnation <= left->second) {
    return std::unexpected(Drop::kStaleIncarnation);
  }
  if (known == nullptr && members_.all().size() == kMembersMax) return std::unexpected(Drop::kTooMany);
  if (introduction->world_hash != config_.world_hash) {
    if (known != nullptr && m.incarnation < known->incarnation) return std::unexpected(Drop::kStaleIncarnation);
    if (const auto member = members_.remove(m.sender)) lose_peer(m.sender, member->name, now, true);
    return on_other_world(m);
  }
  const Membership::Admission admission = members_.on_datagram(now, m.sender, m.incarnation);
  if (admission == Membership::Admission::kJoined || admission == Membership::Admission::kRestarted) {
    settling_until_ = now + kSettling;
    schedule_all_checks();  // not everybody has heard of what rests any more
  }
  switch (admission) {
    case Membership::Admission::kStale:
      return std::unexpected(Drop::kStaleIncarnation);
    case Membership::Admission::kKnown:
      break;
    case Membership::Admission::kJoined:
      outputs_.push_back(PeerJoined{m.sender, introduction->name, false});
      break;
    case Membership::Admission::kRestarted:
      orphan_objects_of(m.sender, now);
      outputs_.push_back(PeerJoined{m.sender, introduction->name, true});
      break;
  }
  return {};
}

std::unexpected<Drop> Peer::on_other_world(const Message& m) {
  if (other_worlds_.size() == kMembersMax) other_worlds_.clear();
  if (other_worlds_.insert(m.sender).second) outputs_.push_back(OtherWorld{m.sender, m.introduction()->name});
  return std::unexpected(Drop::kOtherWorld);
}

void Peer::on_other_version() {
  const std::uint32_t version = codec_.version();
  if (version == 0 || codec_.sender() == kNobody || other_versions_.size() == kVersionsMax) return;
  if (other_versions_.insert(version).second) outputs_.push_back(OtherVersion{codec_.sender(), version});
}

// Somebody who says nothing of himself knows nobody new: who hears him introduces itself, and will be answered.
void Peer::on_unintroduced_peer(HostTime now, PeerId sender) {
  if (other_worlds_.contains(sender)) return;
  unintroduced_peer_at_ = now;
  settling_until_ = now + kSettling;
  introductions_due_ = std::max<std::size_t>(introductions_due_, 1);
}

void Peer::on_update(PeerId sender, std::uint32_t number, UpdateRecord& u, SimTime session_now) {
  const RelaySettings& relay = config_.relay;
  const bool relayed = relay.through == sender;
  if (relay.through != kNobody && !relayed && relay.through != config_.id) return;  // the relay will say
  PeerId object_owner = owner(u.object);
  if (object_owner == kNobody && !relayed) {  // its hello may have been lost
    claim(sender, {&u.object, 1});
    object_owner = owner(u.object);
  }
  if (relayed && own_objects_.contains(u.object)) {
    oldest_update_ = std::max(oldest_update_, session_now - u.at);
    return;
  }
  Member* owner_member = members_.find(object_owner);
  if (owner_member == nullptr || (object_owner != sender && !relayed)) {
    // It may be its owner's successor, or go on under an owner whose claim has not come yet. Regions have no receipts.
    if (!grid_.cuts()) members_.find(sender)->received[kWholeScene].mark_as_missing(number);
    return drop(sender, "not_owner");
  }
  std::uint32_t& last = owner_member->last_sequence[u.object];
  if (u.sequence == last && (receives(u.object) || !interest_.receives(u.model.state.position))) {
    ++counters_.updates_duplicate;
    return;
  }
  if (u.sequence < last) return drop(sender, "old_sequence");
  last = u.sequence;
  oldest_update_ = std::max(oldest_update_, session_now - u.at);
  ++counters_.updates_in;
  if (relay.through == config_.id) {
    if (relay.restamps) u.at = session_now;
    updates_due_.emplace_back(u, u.at);
    ++counters_.updates_relayed;
  }
  if (!accept_by_region(u, session_now)) return;
  const SimTime decided = decisions_.last(u.object);
  if (u.decision < decided && u.at < decided + kDecisionStands) return drop(sender, "before_decision");
  if (decisions_.overruled(u.object, u.decision) && u.at < u.decision + kDecisionStands)
    return drop(sender, "before_decision");
  last_updates_.insert_or_assign(u.object, u);
  set_ghost(u.object, u.at, u.model);
}

void Peer::set_ghost(ObjectId object, SimTime t, const MotionModel& model) {
  replica_->ghosts.set_base(object, t, model);
  if (!own_objects_.contains(object) && replica_->truth.has(object)) replica_->truth.set_base(object, t, model);
}

}  // namespace peerd::replication
