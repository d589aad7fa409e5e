#include "replication/peer/session_keeper.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

namespace peerd::replication {
namespace {

// The truth keeps the positions of driven own objects for so long: contacts with them are found as the samples come.
constexpr Duration kDrivenKept = std::chrono::milliseconds(500);

}  // namespace

bool SessionKeeper::check_suspension(HostTime now) {
  const bool in_session = p_.replica.begun();
  const auto gap = p_.time.check_suspension(now, in_session);
  if (!gap) return false;
  assert(*gap > SessionTime::kSuspendedAfter);
  if (!in_session) return true;
  p_.greeter.greet_anew(now);
  // Datagrams that the kernel had kept of the beginning of the stop have been read already: by them time went on, and
  // ticks did not. It is one stop.
  const SimTime reached = p_.to_session(now), ticked = p_.ticks.last_time();
  const Duration unticked = reached - ticked > SessionTime::kSuspendedAfter ? reached - ticked : Duration{0};
  if (unticked > Duration{0}) move_to_session_time(ticked, reached, true);
  const Duration stopped = *gap + unticked;
  p_.counters.ticks_missed += static_cast<std::uint64_t>(stopped * p_.config.tick_hz / std::chrono::seconds(1));
  p_.outbox.push(HostSuspended{stopped});
  return true;
}

bool SessionKeeper::maintain(HostTime now) {
  if (p_.time.start(now)) p_.greeter.start(now);
  if (check_suspension(now)) return false;
  // No other peer is here that knows how much time has passed: this peer's own clock counts on.
  const bool in_session = p_.replica.begun();
  const Duration gap = in_session ? p_.to_session(now) - p_.ticks.last_time() : Duration{0};
  if (gap > SessionTime::kSuspendedAfter) {
    p_.counters.ticks_missed += static_cast<std::uint64_t>(p_.ticks.number_at(p_.to_session(now)) - p_.ticks.last());
    p_.members.restart_silence_of_all(now);  // this host was silent, not the members
    move_to_session_time(p_.ticks.last_time(), p_.to_session(now), true);
    p_.outbox.push(HostSuspended{gap});
    return false;
  }
  expire_members(now);
  const bool lost_leader = p_.time.has_lost_leader();
  if (p_.time.found_session(now)) {
    if (!p_.replica.begun()) {
      own_as_founder();
      enter_session(now);
    }
  } else if (lost_leader || (!p_.time.follows() && p_.time.clock().synchronised())) {
    follow_leader(now, std::nullopt);
  }
  const auto step = p_.time.adjust(now);
  if (!step) return true;
  const SimTime after = p_.to_session(now);
  ++p_.counters.clock_steps;
  if (!step->same_session) p_.world_time.on_other_session(step->by, p_.time.follows());
  if (p_.replica.begun()) move_to_session_time(after - step->by, after, step->same_session);
  p_.outbox.push(ClockStepped{p_.time.clock().session_minus_host(now), step->by, step->same_session});
  return false;
}

// A near peer that owns an object which this peer receives publishes it where this peer listens, and says there that it
// is here.
void SessionKeeper::expire_members(HostTime now) {
  const auto is_due = [&](PeerId peer) {
    return std::ranges::any_of(p_.owners, [&](const auto& each) {
      return each.second == peer && p_.replica.begun() && p_.regions.is_heard(each.first);
    });
  };
  std::vector<PeerId> far;
  for (auto& [peer, member] : p_.members.expire(now, is_due, p_.time.follows(), &far)) lose(peer, member, now, false);
  for (const PeerId peer : far) p_.exchange.on_lost(peer);
  for (auto& [peer, gone] : p_.members.expire_far(now)) lose(peer, gone, now, false);
}

void SessionKeeper::dismiss_far(PeerId peer, HostTime now) {
  const auto far = p_.members.remove_far(peer);
  if (!far) return;
  p_.admission.note_departed(peer, far->incarnation);
  lose(peer, *far, now, true);
}

void SessionKeeper::follow_leader(HostTime now, std::optional<PeerId> sender) {
  if (p_.time.follow_leader(now, sender, p_.replica.begun())) enter_session(now);
}

// Only who founds a session takes what the file gives to its founder. A peer that joins one, or one that remains when
// its founder has gone, takes nothing: what a founder leaves behind is an orphan as any other.
void SessionKeeper::own_as_founder() {
  assert(!p_.replica.begun());
  std::vector<OwnedObject> taken;
  for (const OwnedObject& each : p_.config.owned_by_founder) {
    if (p_.owners.of(each.object) != kNobody) continue;
    if (p_.model->scene->contains(each.object)) {
      taken.push_back(each);
    } else {  // by an operation of the store
      p_.removed.try_emplace(each.object, RemovedObject{.owner = p_.config.id, .as_founder = true});
    }
  }
  if (taken.empty()) return;
  p_.own.add(taken);
  for (const OwnedObject& each : taken) p_.owners.set(each.object, p_.config.id, true);
}

void SessionKeeper::enter_session(HostTime host_now) {
  assert(!p_.replica.begun());
  const SimTime now = p_.to_session(host_now);
  p_.greeter.on_session_entered(p_.own.size());
  p_.greeter.greet_anew(host_now);
  p_.presence.begin(now);
  begin_worlds(now);
  p_.ticks.set_last(p_.ticks.number_at(now));
  p_.scene.restart(now);
  declare_all();
  p_.scripted.restart();
  for (auto& [object, own] : p_.own) {
    p_.replica.truth().set_base(object, now, at_rest(p_.replica.truth().relative_at(object, now).pose()));
    if (own.driven || p_.config.wait_for_start) continue;
    if (own.launch.after > Duration{0}) {
      p_.launches.schedule(object, now + own.launch.after);
    } else {
      p_.launches.launch(now, object, [this](SimTime at, ObjectId o) { return p_.file_velocity(at, o); });
    }
  }
  give_as_operations_say();
}

// The clock has stepped into another session, or this computer was suspended. Everything goes on from where it is, at
// the new time; what was known of the past, and what was published in it, is void. Decisions of the same session keep
// their times, so that none is applied a second time.
void SessionKeeper::move_to_session_time(SimTime before, SimTime now, bool same_session) {
  p_.replica.compute_all();
  const Replica::Worlds old = p_.replica.take();
  p_.replica.colliding().forget(now);
  p_.display.restart();
  p_.greeter.on_session_entered(p_.own.size());
  p_.greeter.greet_anew(p_.time.clock().to_host(now));
  begin_worlds(now);
  p_.ticks.set_last(p_.ticks.number_at(now));
  p_.decisions.restart(same_session);
  if (!same_session) {
    p_.scene.shift(now - before);
    for (auto& [object, each] : p_.removed) {
      if (each.decided != SimTime{}) each.decided += now - before;
    }
    p_.presence.move(before, now);
  }
  p_.scene.restart_moved(now);
  p_.replica.forget_updates();
  p_.regions.restart_at(now);
  p_.publication.restart();
  declare_all();
  MotionWorld &truth = p_.replica.truth(), &ghosts = p_.replica.ghosts();
  std::set<ObjectId> moved;
  for (const MotionWorld* const world : {&old.truth, &old.ghosts}) {
    std::ranges::copy(world->objects(), std::inserter(moved, moved.end()));
  }
  for (const ObjectId object : moved) {
    const bool orphan = p_.owners.of(object) == kNobody && !ghosts.has(object);
    if (!ghosts.has(object)) ghosts.declare(object, orphan ? Role::kScene : Role::kPredicted);
    if (truth.has(object)) {
      if (const auto free = old.truth.free_acceleration(object)) truth.set_free_acceleration(object, *free);
      truth.set_base(object, now, old.truth.model_at(object, before));
    }
    // An orphan stands until somebody claims it, as one whose owner has gone: one that flew on would be a racket.
    const MotionModel model = old.ghosts.model_at(object, before);
    ghosts.set_base(object, now, orphan ? MotionModel(at_rest(model.state.pose())) : model);
    if (p_.scene.is_moved(object)) {
      p_.scene.at(object).model = old.truth.model_at(object, before);
      p_.scene.at(object).carrier = p_.model->carrier_of(object);
    }
  }
  p_.scripted.restart();
  p_.launches.forget_unpublished();
  p_.launches.shift(now - before);
  for (auto& [object, own] : p_.own) {
    own.last_sent.reset();
    if (own.driven_since) own.driven_since = now;
    own.delivery.record.reset();
    own.models.reset();  // their samples are of the other time
    own.poses = {};
    own.budget = {};
  }
}

void SessionKeeper::begin_worlds(SimTime now) {
  p_.replica.begin(now);
  p_.own.check_all();
  MotionWorld& truth = p_.replica.truth();
  if (!p_.config.display_delay.own && !p_.config.bounded_latency.is_on()) truth.keep_history_of_driven(kDrivenKept);
  // A contact of two owners is decided, and so is one that gives a scene object an owner.
  const auto alone = [&p = p_](ObjectId a, ObjectId b) {
    return !p.owners.have_two(a, b) && !p.decisions.is_free_scene_object(a) && !p.decisions.is_free_scene_object(b);
  };
  const auto of = [&decisions = p_.decisions](ObjectId a, ObjectId b, SimTime contact) {
    return decisions.authority(a, b, contact);
  };
  truth.set_authority({of, alone});
  p_.replica.ghosts().set_authority({{}, alone});
}

void SessionKeeper::declare_all() {
  for (const auto& [object, peer] : p_.owners) {
    if (const OwnObject* own = p_.own.find(object)) {
      p_.replica.truth().declare(object, own->driven ? Role::kDriven : Role::kAuthoritative);
      p_.replica.ghosts().declare(object, Role::kPredicted);
    } else {
      p_.replica.declare_remote(object, Role::kPredicted);
    }
  }
  for (const auto& [object, each] : p_.scene.all()) {
    if (p_.owners.of(object) == kNobody) p_.replica.declare_remote(object, Role::kPredicted);
  }
  watch_all_pairs();
}

void SessionKeeper::watch_all_pairs() {
  p_.regions.measure_contact_ranges(PairNumbers::all_below(p_.model->pairs.size()), true);
  p_.decisions.watch().follow_all();
}

void SessionKeeper::claim(PeerId peer, std::span<const ObjectId> objects, std::uint64_t as_founder,
                          std::optional<SimTime> at) {
  assert(peer != kNobody && peer != p_.config.id);
  std::vector<ObjectId> changed, lost;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const ObjectId object = objects[k];
    if (!p_.model->scene->contains(object)) {
      p_.drop(peer, "object");
      continue;
    }
    const auto given = p_.living.owners().find(object);
    if (given != p_.living.owners().end() && given->second != peer) {
      p_.drop(peer, "given_away");  // an operation counts more than what a configuration says
      continue;
    }
    const PeerId before = p_.owners.of(object);
    const bool by_founder = k < 64 && (as_founder >> k & 1) != 0;
    const bool added = before == kNobody;
    // A decision has given it to the peer before: what a configuration or the file says comes first.
    const bool adopted = p_.scene.contains(object) && !added && before != peer;
    p_.scene.remove(object);
    const bool is_better = std::pair(by_founder, peer) < std::pair(p_.owners.as_founder(object), before);
    const bool taken = !added && peer != before && (adopted || is_better);
    if (before == peer) p_.owners.set(object, peer, by_founder);
    if (!added && !taken) continue;
    if (adopted) p_.decisions.forget(object, p_.ticks.last_time());
    if (taken && !adopted) {
      if (p_.owners.as_founder(object) && !by_founder) {
        p_.outbox.push(FounderGaveWay{object, before, peer});
      } else {
        p_.outbox.push(OwnershipConflict{object, peer});
      }
    }
    if (taken) {
      if (before == p_.config.id) {
        lost.push_back(object);
        p_.launches.forget(object);
      }
      p_.regions.forget_handovers_of(object);
    }
    p_.owners.set(object, peer, by_founder);
    if (added && at) claimed_at_.insert_or_assign(object, *at);
    changed.push_back(object);
  }
  const bool more_moves = p_.let_move(changed);
  if (more_moves) not_carriers_.clear();
  for (const ObjectId object : changed) {
    p_.regions.on_claimed(object, p_.ticks.last_time());
    if (p_.replica.begun()) p_.replica.declare_remote(object, Role::kPredicted);
  }
  p_.own.remove(lost);
  more_moves ? watch_all_pairs() : p_.watch_pairs_around(changed);
}

void SessionKeeper::give(std::span<const std::pair<ObjectId, PeerId>> given, SimTime at, bool take_effect) {
  assert(p_.replica.begun());
  std::vector<ObjectId> changed;
  for (const auto& [object, to] : given) {
    if (!p_.model->scene->contains(object)) continue;  // what it is comes with the same operations
    const PeerId before = p_.owners.of(object);
    const bool is_here = to == p_.config.id || p_.members.contains(to);
    const PeerId owner = is_here ? to : kNobody;
    const bool is_borrowed = p_.scene.contains(object) && before != kNobody;  // until it rests
    const auto claimed = claimed_at_.find(object);
    const bool is_claimed = owner != kNobody && claimed != claimed_at_.end() && claimed->second >= at;
    if (take_effect) claimed_at_.erase(object);
    if (owner == before && !is_borrowed) {
      if (!is_claimed || !take_effect) continue;
      p_.outbox.push(ObjectGiven{object, kNobody, owner, at});
      ++p_.counters.objects_given;
      continue;
    }
    take_from(before, object);
    p_.owners.set(object, owner);
    changed.push_back(object);
    p_.outbox.push(ObjectGiven{object, before, owner, at});
    ++p_.counters.objects_given;
  }
  if (!changed.empty()) follow_owners(changed, at);
}

// These have another owner from that instant on.
void SessionKeeper::follow_owners(std::span<const ObjectId> changed, SimTime at) {
  assert(!changed.empty());
  const bool more_moves = p_.let_move(changed);
  if (more_moves) not_carriers_.clear();
  for (const ObjectId object : changed) {
    const PeerId owner = p_.owners.of(object);
    if (owner == kNobody) {
      end_owning(object, at);
    } else if (owner == p_.config.id) {
      begin_owning(object, at);
    } else {
      p_.regions.on_claimed(object, p_.ticks.last_time());
      p_.replica.declare_remote(object, Role::kPredicted);
    }
  }
  more_moves ? watch_all_pairs() : p_.watch_pairs_around(changed);
}

void SessionKeeper::give_as_operations_say() {
  if (!p_.replica.begun()) return;
  std::vector<std::pair<ObjectId, PeerId>> given(p_.living.owners().begin(), p_.living.owners().end());
  // A contact may have lent what its owner has released, or what belongs to a peer that is not here.
  std::erase_if(given, [&](const auto& each) {
    const bool is_here = each.second == p_.config.id || p_.members.contains(each.second);
    return !is_here && p_.scene.contains(each.first);
  });
  give(given, std::max(p_.ticks.last_time(), p_.replica.begun_at()), false);
}

// Where its owner does not know that it was gone, this peer has lost the owner's updates.
void SessionKeeper::give_back_removed(SimTime at) {
  assert(p_.replica.begun());
  std::vector<ObjectId> changed;
  bool is_any_back = false;
  for (auto next = p_.removed.begin(); next != p_.removed.end();) {
    const auto [object, removed] = *next;
    if (!p_.model->scene->contains(object)) {
      ++next;
      continue;
    }
    next = p_.removed.erase(next);
    is_any_back = true;
    assert(removed.owner != kNobody);
    const bool is_lent = removed.decided != SimTime{};
    const bool is_here = removed.owner == p_.config.id || p_.members.contains(removed.owner);
    if (!is_here || p_.owners.of(object) != kNobody) continue;
    if (is_lent && p_.scene.contains(object)) {
      p_.give_scene_object(object, removed.owner, removed.decided);
      p_.own.republish(object);
    } else if (!is_lent && !p_.living.owners().contains(object)) {
      p_.scene.remove(object);
      p_.owners.set(object, removed.owner, removed.as_founder);
      changed.push_back(object);
    }
  }
  if (!changed.empty()) follow_owners(changed, at);
  if (is_any_back) p_.greeter.on_session_entered(p_.own.size());
}

void SessionKeeper::take_from(PeerId before, ObjectId object) {
  p_.replica.compute_ghost(object);
  p_.regions.forget_handovers_of(object);
  p_.replica.forget_update_of(object);
  if (p_.scene.contains(object)) {
    p_.decisions.forget(object, p_.ticks.last_time());
    p_.scene.remove(object);
  }
  if (before != p_.config.id) return;
  p_.launches.forget(object);
  p_.own.remove({&object, 1});
}

// The object goes on as all have predicted it.
void SessionKeeper::begin_owning(ObjectId object, SimTime at) {
  OwnedObject own{object};
  for (const auto* const settings : {&p_.config.owned, &p_.config.owned_by_founder}) {
    const auto configured = std::ranges::find(*settings, object, &OwnedObject::object);
    if (configured != settings->end()) own = *configured;
  }
  p_.own.add({&own, 1});
  p_.regions.on_known_everywhere(object);
  p_.replica.declare_remote(object, Role::kPredicted);
  const SimTime since = p_.replica.ghosts().law_since(object, std::max(at, p_.ticks.last_time()));
  const MotionModel law = p_.replica.ghosts().model_at(object, since);
  p_.replica.truth().declare(object, own.driven ? Role::kDriven : Role::kAuthoritative);
  p_.replica.truth().set_base(object, since, law);
  p_.own.republish(object);
}

// An object that answers contacts goes on as all have predicted it; any other stands still.
void SessionKeeper::end_owning(ObjectId object, SimTime at) {
  (void)p_.follow_scene_objects(at);
  p_.regions.on_known_everywhere(object);
  MotionWorld& ghosts = p_.replica.ghosts();
  if (!p_.scene.contains(object)) {
    if (!ghosts.has(object)) p_.replica.declare_remote(object, Role::kScene);
    p_.replica.set_ghost(object, at, at_rest(ghosts.relative_at(object, at).pose()), false);
    p_.replica.declare_remote(object, Role::kScene);
    p_.regions.on_orphaned(object);
    return;
  }
  SceneObject& known = p_.scene.at(object);
  known.freed = ghosts.law_since(object, at);
  known.model = ghosts.model_at(object, known.freed);
  known.carrier = p_.model->carrier_of(object);
  p_.scene.note_moved(object);
  p_.replica.set_ghost(object, known.freed, known.model, false);
  p_.replica.declare_remote(object, Role::kPredicted);
}

// Each peer has noticed at another instant that the owner is gone, so that the object stands elsewhere at each: until
// an operation says where (PlaceObject), which may be there already. An object without a ghost stands where the scene
// has it, and this peer cannot say more. `since`: the owner has been here since then.
void SessionKeeper::leave_behind(ObjectId object, const LeftBehind& left, SimTime since) {
  if (!p_.replica.ghosts().has(object)) return;
  const auto said = p_.living.left().find(object);
  const bool is_said = said != p_.living.left().end() && said->second.owner == left.owner && said->second.at >= since;
  const Pose pose = is_said ? p_.place_by_scene(object) : p_.replica.ghosts().relative_at(object, left.at).pose();
  p_.replica.set_ghost(object, left.at, at_rest(pose), false);
  // The ghost of what could collide may be in what its owner would have met: no place for all.
  if (!is_said && p_.model->pairs_of(object).empty()) p_.left_behind[object] = left;
}

void SessionKeeper::let_move(ObjectId carrier) {
  if (not_carriers_.contains(carrier)) return;
  if (p_.let_move({&carrier, 1})) watch_all_pairs();
  if (!p_.model->is_carrier(carrier)) not_carriers_.insert(carrier);
}

void SessionKeeper::follow_scene() {
  not_carriers_.clear();
  watch_all_pairs();
}

void SessionKeeper::lose(PeerId peer, const OtherPeer& gone, HostTime now, bool left_gracefully) {
  orphan_objects_of(peer, gone.since, now, left_gracefully);
  p_.greeter.on_peer_lost(peer);
  p_.exchange.on_lost(peer);
  p_.outbox.push(PeerLost{peer, gone.name, left_gracefully});
}

void SessionKeeper::orphan_objects_of(PeerId peer, HostTime since, HostTime now, bool for_good) {
  if (p_.world_time.on_peer_lost(peer)) {
    reintroduce();
    p_.scripted.restart();
  }
  const SimTime t = p_.to_session(now);
  // The places of its objects are read below: some of their laws may wait to be laid again.
  if (p_.replica.begun()) p_.replica.catch_up_ghosts();
  p_.own.forget_acknowledgements_of(peer);
  std::erase_if(p_.removed, [&](const auto& each) { return each.second.owner == peer; });
  bool owned_any = false;
  for (const auto& [object, owner] : p_.owners) {
    if (owner != peer) continue;
    owned_any = true;
    const LeftBehind left{owner, t, p_.replica.receives(object)};
    if (p_.scene.contains(object) && p_.replica.begun()) {
      scene_.orphan(object, t);
      continue;
    }
    if (p_.replica.begun() && p_.living.owners().contains(object)) {
      if (left.was_received) p_.outbox.push(ObjectOrphaned{object, peer});
      take_from(peer, object);
      if (for_good) p_.decisions.end_life_of(object, t);
      p_.owners.set(object, kNobody);
      end_owning(object, t);
      if (!p_.scene.contains(object)) leave_behind(object, left, p_.to_session(since));
      continue;
    }
    if (p_.replica.begun()) {
      p_.replica.compute_ghost(object);
      leave_behind(object, left, p_.to_session(since));
      p_.replica.declare_remote(object, Role::kScene);
      if (left.was_received) p_.outbox.push(ObjectOrphaned{object, peer});
      p_.replica.forget_update_of(object);
    }
    p_.regions.on_orphaned(object);
    // Before it begins, this peer does not know the session's time: its own may be seconds ahead.
    if (for_good) p_.decisions.end_life_of(object, p_.replica.begun() ? t : SimTime::min());
    p_.owners.set(object, kNobody);
  }
  if (owned_any) watch_all_pairs();  // a pass over all pairs: not for each datagram that says goodbye
}

}  // namespace peerd::replication
