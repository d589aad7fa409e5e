// Peer: entering, changing and keeping a session; who runs what in it.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/scene/bounding_radius.hpp"
#include "replication/decision/decision.hpp"
#include "replication/wire/hello_lists.hpp"
#include "replication/peer.hpp"
#include "replication/motion/response.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// Of lost peers, so many are told that they were. More than one network carries.
constexpr std::size_t kLostPeersMax = 4096;
// Who has not been named in so many turns is not heard: enough for one hello in ten lost (0.1^4 = 0.0001).
constexpr std::size_t kTurnsUnechoed = 4;
// Who has not named this peer in so many hears nothing of it: no copy gets there, nor does an introduction.
constexpr std::size_t kTurnsUnreachable = 20;
// World time beyond which a nanosecond count would overflow: 100 years.
constexpr double kFarthest_s = 3.2e9;

template <class T>
std::vector<T> without_doubles(std::vector<T> all) {
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

}  // namespace

// What the world moves by itself is told to both worlds anew, from where it is now.
void Peer::restart_predefined_motion() {
  predefined_pieces_.clear();
  for (const ObjectId object : model_.moving) predefined_pieces_.push_back({object, std::nullopt, std::nullopt});
}

// Tells both worlds how what the file moves goes on until `to`. Pieces begin at the same instants with the same bits on
// every peer, whenever it came; but what somebody ran until now is not moved in its past.
void Peer::extend_predefined(SimTime to) {
  if (!world_zero_) return;
  // Rounded up to where a nanosecond lies within a piece.
  const auto session_time = [&](double world_s) {
    return *world_zero_ + Duration{static_cast<std::int64_t>(std::ceil(world_s * 1e9))};
  };
  for (Predefined& p : predefined_pieces_) {
    if (owner(p.object) != kNobody) {  // somebody runs it: that counts
      p.known_until.reset();
      p.run_until = to;
      continue;
    }
    while (!p.known_until || *p.known_until <= to) {
      const SimTime from = p.known_until.value_or(to);
      const PredefinedMotion::Piece piece = predefined_->piece(p.object, to_seconds(from - *world_zero_));
      const SimTime begin = std::max(session_time(piece.begin_s), p.run_until.value_or(SimTime::min()));
      const KinematicState state = advance(piece.state, to_seconds(begin - *world_zero_) - piece.begin_s);
      replica_->truth.set_base(p.object, begin, state);
      replica_->ghosts.set_base(p.object, begin, state);
      const bool ends = piece.end_s < kFarthest_s;
      p.known_until = ends ? std::max(session_time(piece.end_s), from + Duration{1}) : SimTime::max();
    }
  }
}

// False when everything begins anew at this instant, and what was due is not.
bool Peer::maintain_session(HostTime now) {
  if (!started_) {
    started_ = listening_since_ = now;
    next_hello_ = now;
  }
  if (detect_suspension(now)) return false;
  if (const Duration gap = replica_ ? clock_.to_session(now) - tick_time(last_tick_) : Duration{0}; gap > kSuspendedAfter) {
    counters_.ticks_missed += static_cast<std::uint64_t>(tick_number(clock_.to_session(now)) - last_tick_);
    members_.restart_silence_of_all(now);  // it was not they who were silent
    move_to_session_time(tick_time(last_tick_), clock_.to_session(now));
    outputs_.push_back(HostSuspended{gap});
    return false;
  }
  for (auto& [peer, member] : members_.expire(now)) {
    lose_peer(peer, member.name, now, false);
  }
  const bool leader_left = follows_ && follows_ != config_.id && members_.find(*follows_) == nullptr;
  if (!found_session(now) && leader_left) follow_leader(now, std::nullopt);
  if (const auto step = clock_.adjust(now)) {
    const SimTime after = clock_.to_session(now);
    ++counters_.clock_steps;
    const bool same_session = std::exchange(was_suspended_, false);
    if (!same_session) {
      // The other session's counts, as the peer says that is followed into it.
      if (world_zero_) previous_world_zero_ = std::exchange(world_zero_, std::nullopt);
      if (previous_world_zero_) *previous_world_zero_ += *step;
      world_zero_source_ = follows_;
      clock_stepped_ = true;
    }
    if (replica_) move_to_session_time(after - *step, after);
    outputs_.push_back(ClockStepped{clock_.session_minus_host(now), *step, same_session});
    return false;
  }
  if (clock_.synchronised()) was_suspended_ = false;
  return true;
}

void Peer::on_hello(HostTime now, PeerId sender, std::uint32_t number, const Hello& hello) {
  Member& member = *members_.find(sender);
  const Introduction* introduction = hello.introduction ? &*hello.introduction : nullptr;
  const bool is_newest = number > member.hello;
  member.hello = number;
  member.hello_rx = now;
  member.awaits_our_decision = std::ranges::any_of(hello.notes, [&](const ContactNote& n) {
    return n.deferred && may_decide(config_.id, owner(n.collider), owner(n.collidee));
  });
  if (hello.sessions != member.sessions) {  // it knows of no updates yet
    resend_all();
    for (DecisionLog::Entry& decision : decisions_.entries()) {
      decision.sent_in.clear();
      decision.acknowledged_by.erase(sender);
    }
    if (world_zero_) reintroduce();
  }
  member.sessions = hello.sessions;
  member.synchronised = hello.session_tx.has_value();
  member.latency = hello.latency;
  if (introduction != nullptr) {
    member.name = introduction->name;
    member.start = introduction->start;
    member.viewpoint = introduction->viewpoint;
    // Who is in another session has told nothing yet that this one could take.
    const Duration ahead = hello.session_tx && replica_ ? *hello.session_tx - clock_.to_session(now) : Duration{0};
    if (hello.session_tx && ahead > -kUpdateAgeMax && ahead < kUpdateAheadMax) claim(sender, introduction->owned);
  }
  const auto named = std::ranges::find(hello.echoes, config_.id, &Echo::peer);
  // Of more than this peer has sent: its last life's.
  const bool counts = named != hello.echoes.end() && named->received.highest <= datagram_numbers_[kWholeScene];
  const Echo* echo = counts ? &*named : nullptr;
  on_echo(sender, member, echo, hello.echoes);
  if (hello.session_tx && replica_ && clock_.synchronised()) {
    measure_latency(member, now, *hello.session_tx);
    on_contact_notes(sender, hello, clock_.to_session(now));
  }

  const bool zero_counts = sender == follows_ || (!world_zero_ && (!clock_stepped_ || sender == world_zero_source_));
  const auto zero = introduction != nullptr && hello.session_tx ? introduction->world_zero : std::nullopt;
  if (zero && zero_counts && zero != world_zero_) {
    world_zero_ = zero;
    previous_world_zero_.reset();
    reintroduce();
    restart_predefined_motion();
  }
  if (is_newest) {
    on_stamps(now, member, hello, echo);
    follow_leader(now, sender);
  }
}

// What the sender's hello says of this peer's datagrams; null: nothing.
void Peer::on_echo(PeerId sender, Member& member, const Echo* echo, std::span<const Echo> all) {
  if (echo == nullptr) {
    // A hello may name others only because it is their turn; then many in a row without this peer's name say it, too.
    const std::size_t turn = hellos_to_name(members_.all().size());
    ++member.hellos_without_echo;
    member.unreachable = member.hellos_without_echo > kTurnsUnreachable * turn;
    const bool unnamed = leaves_out(all, config_.id) || member.hellos_without_echo > kTurnsUnechoed * turn;
    if (unnamed && std::exchange(member.echoes_us, false)) {
      member.stopped_echoing_us = true;
      member.acknowledgement.reset();
    }
    return;
  }
  member.hellos_without_echo = 0;
  member.unreachable = false;
  member.echoes_us = true;
  if (std::exchange(member.stopped_echoing_us, false)) {  // what it has forgotten stands still there
    resend_all();
  }
  member.loss_to_peer = echo->loss;
  if (!member.acknowledgement) member.acknowledgement.emplace(echo->received);
  member.acknowledgement->on_echo(*echo);
  for (auto& [object, own] : own_objects_) {
    if (own.acknowledged_by.contains(sender)) continue;
    if (std::ranges::none_of(own.sent_in, [&](std::uint32_t n) { return member.acknowledgement->has(n); })) continue;
    own.acknowledged_by.insert(sender);
    own.unacknowledged_by.erase(sender);
  }
  on_acknowledgement(sender, *member.acknowledgement);
}

// Somebody may not have what was told.
void Peer::resend_all() {
  for (auto& [object, own] : own_objects_) own.resend = true;
  schedule_all_checks();
}

// How long the farthest of the others waits for what is sent now.
Duration Peer::farthest_latency() const {
  Duration farthest{0};
  for (const auto& [peer, member] : members_.all())
    farthest = std::max(farthest, member.mean_delay().value_or(Duration{0}));
  return farthest;
}

void Peer::enter_session(HostTime host_now) {
  const SimTime now = clock_.to_session(host_now);
  ++sessions_;
  reintroduce();
  next_hello_ = host_now;
  settling_until_ = host_now + kSettling;
  begin_worlds(now);
  last_tick_ = tick_number(now);
  declare_all();
  restart_predefined_motion();
  for (auto& [object, own] : own_objects_) {
    replica_->truth.set_base(object, now, at_rest(model_.scene->rigid_pose(object)));
    if (own.driven || config_.wait_for_start) continue;
    if (own.launch.after > Duration{0}) {
      scheduled_launches_[object] = now + own.launch.after;
    } else {
      launch(now, object, own);
    }
  }
}

Vec3 Peer::to_world(SimTime at, ObjectId object, const Vec3& in_parent) {
  if (!predefined_ || !world_zero_) return model_.scene->to_world(object, in_parent);
  return predefined_->to_world(object, in_parent, to_seconds(at - *world_zero_));
}

// The world's velocityVector is in its parent's frame.
void Peer::launch(SimTime at, ObjectId object, OwnObject& own) {
  KinematicState state = replica_->truth.at(object, at);
  state.velocity =
      own.launch.velocity ? *own.launch.velocity : to_world(at, object, model_.scene->object(object).velocity);
  state.acceleration = own.launch.acceleration;
  replica_->truth.set_base(object, at, law_after(model_.response_of(object), MotionModel{}, state));
}

// The launches that are due, in order of time.
void Peer::begin_motions(SimTime until) {
  std::vector<std::pair<SimTime, ObjectId>> due;
  for (const auto& [object, at] : scheduled_launches_) {
    if (at <= until) due.emplace_back(at, object);
  }
  std::ranges::sort(due);
  for (const auto& [at, object] : due) {
    replica_->truth.advance(at);
    launch(at, object, own_objects_.at(object));
    unpublished_changes_[object] = at;
    scheduled_launches_.erase(object);
  }
}

bool Peer::change_velocity(HostTime now, ObjectId object, const Vec3& velocity, bool absolute) {
  const auto own = own_objects_.find(object);
  if (!replica_ || own == own_objects_.end() || own->second.driven) return false;
  const SimTime t = std::max(clock_.to_session(now), tick_time(last_tick_));
  begin_motions(t);
  replica_->truth.advance(t);
  const MotionModel law = replica_->truth.model_at(object, t);
  KinematicState state = law.state;
  state.velocity = absolute ? velocity : Vec3(state.velocity + velocity);
  replica_->truth.set_base(object, t, law_after(model_.response_of(object), law, state));
  scheduled_launches_.erase(object);
  unpublished_changes_[object] = t;  // nobody could know
  return true;
}

void Peer::start_motions(HostTime now, SimTime start) {
  if (!replica_) return;
  const SimTime from = std::max(start, clock_.to_session(now));
  for (auto& [object, own] : own_objects_) {
    if (!own.driven) scheduled_launches_[object] = from + own.launch.after;
  }
}

// The clock has stepped into another session, or this computer has slept. Everything goes on from where it is, at the
// other session's time; what was known of the past, and what the others were told in the old time, is void.
void Peer::move_to_session_time(SimTime before, SimTime now) {
  const Replica old = std::move(*replica_);
  colliding_.forget(now);
  shown_.clear();
  ++sessions_;
  reintroduce();
  next_hello_ = clock_.to_host(now);
  settling_until_ = *next_hello_ + kSettling;
  begin_worlds(now);
  last_tick_ = tick_number(now);
  decisions_.clear();
  deferred_contacts_.clear();
  last_updates_.clear();
  pending_subscriptions_.clear();  // all others tell everything anew
  interest_.restart_at(now);
  for (const auto& [object, peer] : owners_) {
    if (grid_.cuts() && peer != config_.id) stop_receiving(object);  // it may have gone anywhere
  }
  updates_due_.clear();
  copies_due_.clear();
  oldest_update_ = Duration{0};
  declare_all();
  for (const ObjectId object : old.ghosts.objects()) {
    if (!replica_->ghosts.has(object)) replica_->ghosts.declare(object, Role::kScene);  // frozen, and meets nothing
    if (replica_->truth.has(object)) replica_->truth.set_base(object, now, old.truth.model_at(object, before));
    replica_->ghosts.set_base(object, now, old.ghosts.model_at(object, before));
  }
  restart_predefined_motion();
  unpublished_changes_.clear();
  for (auto& [object, start] : scheduled_launches_) start += now - before;
  for (auto& [object, own] : own_objects_) {
    own.last_sent.reset();
    own.to_repeat.reset();
    own.models.reset();  // their samples are of the other time
    own.poses = {};
    own.budget = {};
  }
}

void Peer::declare_all() {
  for (const auto& [object, peer] : owners_) {
    const auto own = own_objects_.find(object);
    if (own != own_objects_.end()) {
      replica_->truth.declare(object, own->second.driven ? Role::kDriven : Role::kAuthoritative);
      replica_->ghosts.declare(object, Role::kPredicted);
    } else {
      declare_remote(object, Role::kPredicted);
    }
  }
  watch_decided_pairs();
}

// What nothing can meet is what the ghosts say: the truth has no use for it.
void Peer::declare_remote(ObjectId object, Role role) {
  if (replica_->truth.has(object)) replica_->truth.declare(object, role);
  replica_->ghosts.declare(object, role);
}

// The truth watches what this peer finds. Ghosts are watched wherever they may meet something, own ones included:
// the sender must know what every receiver predicts, or a predicted collision would cost an update.
// What this peer does not hear of meets nothing.
void Peer::watch_decided_pairs() {
  std::vector<std::uint32_t> all(model_.pairs.size());
  std::iota(all.begin(), all.end(), 0U);
  for (auto& [object, own] : own_objects_) own.contact_range_m = 0.0;
  measure_contact_ranges(all);
  watch_decided_pairs(all);
}

// Somebody runs these from now on: that is news to their pairs, and to those of what they are paired with.
void Peer::watch_pairs_around(std::span<const ObjectId> objects) {
  const auto pairs_of = [&](std::span<const ObjectId> some) {
    std::vector<std::uint32_t> pairs;
    for (const ObjectId object : some) std::ranges::copy(model_.pairs_of(object), std::back_inserter(pairs));
    return without_doubles(std::move(pairs));
  };
  const std::vector<std::uint32_t> theirs = pairs_of(objects);
  std::vector<ObjectId> paired;
  for (const std::uint32_t number : theirs) {
    paired.push_back(model_.pairs[number].collider);
    paired.push_back(model_.pairs[number].collidee);
  }
  const std::vector<std::uint32_t> around = pairs_of(without_doubles(std::move(paired)));
  measure_contact_ranges(theirs);
  watch_decided_pairs(around);
}

void Peer::watch_decided_pairs(std::span<const std::uint32_t> pairs) {
  if (!replica_) return;
  const auto ours = [&](ObjectId id) { return own_objects_.contains(id); };
  std::map<ObjectId, bool> partners;
  // A remote object whose collisions with ours this peer finds, or with any as the server.
  const auto is_partner = [&](ObjectId object) {
    const auto [at, is_new] = partners.try_emplace(object, false);
    if (is_new && !ours(object) && owner(object) != kNobody) {
      at->second = std::ranges::any_of(model_.pairs_of(object), [&](std::uint32_t number) {
        return searches_contacts_of(model_.pairs[number].collider, model_.pairs[number].collidee);
      });
    }
    return at->second;
  };
  for (const std::uint32_t number : pairs) {
    const auto& [a, b, type, mutual] = model_.pairs[number];
    const bool here = receives(a) && receives(b), mine = ours(a) || ours(b);
    replica_->truth.watch(number, here && (mine ? searches_contacts_of(a, b) : is_partner(a) || is_partner(b)));
    replica_->ghosts.watch(number, here && config_.policy.predict_collisions);
  }
}

// Nobody runs an object that somebody else runs already; of two who both say so the lower id is believed.
void Peer::claim(PeerId peer, std::span<const ObjectId> objects) {
  std::vector<ObjectId> changed;
  bool lost_own = false;
  for (ObjectId object : objects) {
    if (object.value >= model_.scene->instances.size()) {
      drop(peer, "object");
      continue;
    }
    const PeerId before = owners_.of(object);
    const bool added = before == kNobody, taken = !added && peer < before;
    if (taken) {
      outputs_.push_back(OwnershipConflict{object, peer});
      if (before == config_.id) {
        own_objects_.erase(object);
        lost_own = true;
        scheduled_launches_.erase(object);
        unpublished_changes_.erase(object);
      }
      std::erase_if(pending_handovers_, [&](const PendingHandover& d) { return d.handover.object == object; });
    }
    if (!added && !taken) continue;
    owners_.set(object, peer);
    if (grid_.cuts() && config_.interest_radius_m) {
      remote_reach_m_ = std::max(remote_reach_m_, bounding_radius_m(*model_.scene, object));
    }
    changed.push_back(object);
    // Where an owner has it who was away, nobody here has heard.
    if (grid_.cuts()) stop_receiving(object);
    if (replica_) {
      if (grid_.cuts()) colliding_.forget(object, tick_time(last_tick_));
      declare_remote(object, Role::kPredicted);
    }
  }
  if (lost_own) index_own_objects();
  watch_pairs_around(changed);
}

void Peer::lose_peer(PeerId peer, const std::string& name, HostTime now, bool left_gracefully) {
  orphan_objects_of(peer, now);
  if (lost_peers_.size() < kLostPeersMax) lost_peers_[peer] = 0;
  outputs_.push_back(PeerLost{peer, name, left_gracefully});
}

// A peer is gone, or begins anew. What it ran stands still from now on, and belongs to nobody.
void Peer::orphan_objects_of(PeerId peer, HostTime now) {
  if (world_zero_source_ == peer && !world_zero_) {  // it never said: this peer's own goes on, or anybody's
    world_zero_source_.reset();
    clock_stepped_ = false;
    world_zero_ = std::exchange(previous_world_zero_, std::nullopt);
    reintroduce();
    restart_predefined_motion();
  }
  const SimTime t = clock_.to_session(now);
  for (auto& [object, own] : own_objects_) {
    own.acknowledged_by.erase(peer);
    own.unacknowledged_by.erase(peer);
  }
  bool owned_any = false;
  for (const auto& [object, owner] : owners_) {
    if (owner != peer) continue;
    owned_any = true;
    if (replica_) {
      set_ghost(object, t, at_rest(replica_->ghosts.at(object, t).pose()));
      declare_remote(object, Role::kScene);
      if (receives(object)) outputs_.push_back(ObjectOrphaned{object, peer});
      last_updates_.erase(object);
    }
    last_receptions_.erase(object);  // it stays where it is: who leaves its region keeps it
    owners_.set(object, kNobody);
  }
  if (owned_any) watch_decided_pairs();  // a pass over all pairs: not for each datagram that says goodbye
}

}  // namespace peerd::replication
