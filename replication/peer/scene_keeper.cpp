#include "replication/peer/scene_keeper.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "replication/objects/contacts/decision_log.hpp"
#include "replication/wire/codec.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// A decision that conflicts with the one that has given an object to this peer may be of so much later.
constexpr Duration kOwnedAtLeast = DecisionLog::kSameCollision;
// The most copies of a state that this peer leaves, one a tick, as the loss asks.
constexpr std::uint32_t kStateCopies = 3;
// Digests are of the last whole second that was over for so long when the hello left: by then all peers have computed
// what has happened.
constexpr Duration kDigestGrid = std::chrono::seconds(1), kDigestAge = std::chrono::milliseconds(500);
// A state on its way to a member explains one hello with another digest, but not two.
constexpr std::uint32_t kDiffersFor = 2;
// States are sent anew no more often, in at most so many datagrams, about 400 objects that rest; the next
// ones follow the next time.
constexpr Duration kOffersApart = std::chrono::seconds(1);
constexpr std::size_t kOfferMax_datagrams = 16;
// The owner of a lent object that moves publishes it when its time threshold is over, and puts that off once at most,
// by a decision; one that rests is let go. So long after that its update has come, repeated where it was lost.
constexpr Duration kUpdateComesWithin = std::chrono::seconds(2);
// A datagram's header leaves so much for states.
constexpr std::size_t kStatesMax_bytes = kDatagramMax_bytes - 19 - kSceneHeader_bytes;

SimTime digest_time(SimTime session_tx) { return floor_to(session_tx - kDigestAge, kDigestGrid); }

}  // namespace

void SceneKeeper::maintain(SimTime t) {
  assert(p_.replica.begun());
  let_go_of_resting(t);
  reset_ghosts(t);
  send_copies();
}

void SceneKeeper::let_go_of_resting(SimTime t) {
  std::vector<UpdateRecord> resting;
  for (const ObjectId object : p_.scene.adopted()) {
    const SimTime decided = p_.scene.decided(object);
    const MotionWorld& truth = p_.replica.truth();
    if (t - decided < kOwnedAtLeast || p_.decisions.awaits_decision_on(object)) continue;
    if (!truth.stands_in_carrier_from(object, t)) continue;
    // Updates of this peer may still be on their way: what is lost would have the next number.
    const std::uint32_t sequence = p_.own.at(object).sequence + 2;
    resting.push_back(
        {object, sequence, t, at_rest(truth.relative_at(object, t).pose()), decided, {}, p_.model->carrier_of(object)});
  }
  for (const UpdateRecord& state : resting) {
    let_go(state);
    p_.scene.at(state.object).copies = copies_against(p_.members.worst_loss_to_peers(), kStateCopies);
    p_.scene.left().push_back(state.object);
  }
}

// Nobody owns the object of that state from now on.
void SceneKeeper::let_go(const UpdateRecord& state) {
  assert(p_.scene.contains(state.object) && p_.replica.begun());
  SceneObject& known = p_.scene.at(state.object);
  p_.set_owner_of_scene_object(state.object, kNobody, p_.owners.of(state.object));
  known.decided = state.decision;
  known.is_free = true;
  known.sequence = state.sequence;
  known.freed = state.at;
  known.model = *p_.replica.base_of(state).model;
  known.carrier = p_.model->carrier_of(state.object);
  known.copies = 0;
  p_.scene.note_moved(state.object);
  p_.scene.differing().erase(state.object);
  p_.replica.forget_update_of(state.object);
  p_.replica.set_ghost(state.object, state.at, known.model, false);
}

void SceneKeeper::reset_ghosts(SimTime t) {
  if (p_.scene.differing().empty()) return;
  const Duration patience = 2 * p_.members.longest_latency() + 3 * p_.config.hello_period;
  MotionWorld &truth = p_.replica.truth(), &ghosts = p_.replica.ghosts();
  for (auto at = p_.scene.differing().begin(); at != p_.scene.differing().end();) {
    const auto [object, since] = *at;
    SceneObject& known = p_.scene.at(object);
    const SimTime law = ghosts.law_since(object, t);
    const bool same_law =
        law == truth.law_since(object, t) && moves_alike(ghosts.relative_at(object, t), truth.relative_at(object, t));
    const bool differs = !same_law && law != known.ghost_reset;
    if (differs && t - since < patience) {
      ++at;
      continue;
    }
    if (differs) {
      p_.replica.note_change_ahead(object);
      ghosts.set_base(object, t, truth.model_at(object, t));
      known.ghost_reset = t;
    }
    at = p_.scene.differing().erase(at);
  }
}

void SceneKeeper::orphan(ObjectId object, SimTime t) {
  assert(p_.owners.of(object) != kNobody && p_.owners.of(object) != p_.config.id);
  p_.replica.compute_ghost(object);
  SceneObject& known = p_.scene.at(object);
  p_.set_owner_of_scene_object(object, kNobody, p_.owners.of(object));
  known.is_free = true;
  ++known.sequence;
  const MotionWorld& ghosts = p_.replica.ghosts();
  const SimTime since = ghosts.law_since(object, t);
  known.freed = since;
  known.model = ghosts.model_at(object, since);
  known.carrier = p_.model->carrier_of(object);
  p_.replica.note_change_ahead(object);
  p_.replica.truth().set_base(object, since, known.model);
  p_.replica.forget_update_of(object);
}

bool SceneKeeper::take_over(PeerId sender, const UpdateRecord& update) {
  assert(sender != p_.config.id && p_.members.contains(sender));
  SceneObject& known = p_.scene.at(update.object);
  const PeerId owner = p_.owners.of(update.object);
  if (update.decision > p_.ticks.last_time() + kUpdateAheadMax) return false;
  if (owner != sender && p_.decisions.log().overruled(update.object, update.decision)) return false;
  // Its owner was only silent.
  const bool is_back = update.decision == known.decided && owner == kNobody && update.sequence >= known.sequence;
  if (owner != sender && update.decision <= known.decided && !is_back) return false;
  if (owner != sender || update.decision > known.decided) {
    p_.give_scene_object(update.object, sender, update.decision);
  } else if (update.sequence > known.sequence && p_.decisions.log().last(update.object) < known.decided) {
    // Peers that step into another session shift the times that they know, each by what it takes for the difference.
    // What its owner says is what ends the loan one day.
    known.decided = update.decision;
  }
  known.sequence = std::max(known.sequence, update.sequence);
  return true;
}

// ---- the same at all peers ----

std::uint64_t SceneKeeper::digest(SimTime session_tx) const {
  if (!p_.replica.begun()) return 0;
  return p_.scene.digest(p_.owners, p_.replica.truth(), digest_time(session_tx));
}

void SceneKeeper::on_digest(Member& member, const Hello& hello) {
  if (!hello.session_tx || !p_.replica.begun()) return;
  member.has_scene_states = hello.scene_digest != 0;
  member.scene_differs = hello.scene_digest == digest(*hello.session_tx) ? 0 : member.scene_differs + 1;
}

void SceneKeeper::on_states(PeerId sender, const SceneStates& scene) {
  const MotionWorld& truth = p_.replica.truth();
  for (const UpdateRecord& state : scene.states) {
    if (!p_.scene.contains(state.object)) {
      p_.drop(sender, "not_scene");
      continue;
    }
    if (state.carrier && !p_.model->may_carry(*state.carrier, state.object)) {
      p_.drop(sender, "carrier");
      continue;
    }
    if (std::max(state.at, state.decision) > p_.ticks.last_time() + kUpdateAheadMax) {
      p_.drop(sender, "update_time");
      continue;
    }
    SceneObject& known = p_.scene.at(state.object);
    // A peer that has taken this one for gone says how its object went on; this peer's updates will say otherwise.
    const bool is_ours = p_.owners.of(state.object) == p_.config.id && state.decision <= known.decided;
    if (is_ours || !p_.scene.supersedes(state, scene.since)) continue;
    const bool is_same = p_.owners.of(state.object) == kNobody && p_.scene.is_moved(state.object) &&
                         known.decided == state.decision && truth.law_since(state.object, state.at) == state.at;
    if (!is_same) let_go(state);
    known.since = scene.since;
  }
}

// A decision may be in force here alone: its author has overruled it by one of a peer that has gone since, or has
// started anew. Then nobody would ever end the loan, and nobody else's word would count against it.
void SceneKeeper::end_unconfirmed_loans(SimTime t) {
  assert(p_.replica.begun());
  if (p_.config.regions.cell_m > 0.0) return;  // not all updates come here
  const Duration patience = 2 * p_.config.policy.time_threshold + kUpdateComesWithin;
  std::vector<ObjectId> over;
  for (const auto& [object, known] : p_.scene.all()) {
    const PeerId owner = p_.owners.of(object);
    if (owner == kNobody || owner == p_.config.id || t - known.decided < patience) continue;
    const UpdateRecord* const update = p_.replica.last_update_of(object);
    if (update == nullptr || update->decision < known.decided) over.push_back(object);
  }
  for (const ObjectId object : over) {
    orphan(object, t);
    SceneObject& known = p_.scene.at(object);
    p_.decisions.forget(object, known.decided + Duration{1});
    known.decided = SimTime{};
    ++p_.counters.drops["loan_unconfirmed"];
  }
}

// The lowest id of all peers with one digest sends, so that not all answer a joining peer.
void SceneKeeper::offer(HostTime now) {
  if (p_.replica.begun()) end_unconfirmed_loans(p_.ticks.last_time());
  if (!p_.replica.begun() || (offered_at_ && now - *offered_at_ < kOffersApart)) return;
  bool wanted = false;
  for (const auto& [peer, member] : p_.members.all()) {
    if (!member.synchronised) continue;
    if (member.scene_differs == 0 && peer < p_.config.id) return;
    wanted = wanted || member.scene_differs >= (member.has_scene_states ? kDiffersFor : 1);
  }
  if (!wanted) return;
  const SimTime last = p_.ticks.last_time();
  const std::vector<UpdateRecord> states = p_.scene.states(p_.owners, p_.replica.truth(), last);
  if (states.empty()) return;
  offered_at_ = now;
  if (next_offered_ >= states.size()) next_offered_ = 0;
  const std::size_t sent = send(std::span(states).subspan(next_offered_));
  next_offered_ = next_offered_ + sent < states.size() ? next_offered_ + sent : 0;
}

// The states of objects that this peer has just let go are sent a few times, a tick apart.
void SceneKeeper::send_copies() {
  if (p_.scene.left().empty()) return;
  std::vector<UpdateRecord> due;
  for (const UpdateRecord& state : p_.scene.states(p_.owners, p_.replica.truth(), p_.ticks.last_time())) {
    SceneObject& known = p_.scene.at(state.object);
    if (known.copies == 0) continue;
    --known.copies;
    due.push_back(state);
  }
  std::erase_if(p_.scene.left(),
                [&](ObjectId object) { return p_.owners.of(object) != kNobody || p_.scene.at(object).copies == 0; });
  (void)send(due);  // the digest finds what does not go
}

// Returns the number of states that were sent.
std::size_t SceneKeeper::send(std::span<const UpdateRecord> states) {
  std::size_t datagrams = 0, used_bytes = 0, sent = 0;
  Message m = p_.outbox.blank();
  const auto flush = [&] {
    if (m.scene.states.empty()) return;
    m.scene.since = SimTime::min();
    for (const UpdateRecord& state : m.scene.states) {
      m.scene.since = std::max(m.scene.since, p_.scene.at(state.object).since);
    }
    sent += m.scene.states.size();
    p_.outbox.send(m);
    m = p_.outbox.blank();
    used_bytes = 0;
    ++datagrams;
  };
  for (const UpdateRecord& state : states) {
    const SimTime first = m.scene.states.empty() ? state.at : m.scene.states.front().at;
    if (used_bytes + encoded_size_bytes(state, first) > kStatesMax_bytes) flush();
    if (datagrams == kOfferMax_datagrams) return sent;
    m.scene.states.push_back(state);
    used_bytes += encoded_size_bytes(state, m.scene.states.front().at);
  }
  flush();
  assert(sent == states.size());
  return sent;
}

}  // namespace peerd::replication
