#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/peer/peer_parts.hpp"
#include "replication/peer/scene_keeper.hpp"

namespace peerd::replication {

// Does what concerns all parts of a peer at once: entering a session, stepping into another one, and changes of
// members and of owners.
class SessionKeeper {
 public:
  SessionKeeper(PeerParts& parts, SceneKeeper& scene) : p_(parts), scene_(scene) {}

  // The caller calls it first whenever time arrives. True where this host was suspended: no time of before this call
  // means anything.
  bool check_suspension(HostTime now);
  // Maintains members, session and clock at every call of on_tick(). False when everything begins anew at this
  // instant, and a tick that was due is void.
  [[nodiscard]] bool maintain(HostTime now);
  // A hello has come, whose time stamps are known by now: follows the right peer.
  void follow_leader(HostTime now, std::optional<PeerId> sender);

  // A peer claims these objects: those without an owner are its own from now on, and those of another owner only if its
  // claim is better. Of two owners a founder of a session gives way, then the higher id. `as_founder`, bit k: the claim
  // of the k-th object is a founder's. `at`: the session time at which the peer has said so, where that is known.
  void claim(PeerId peer, std::span<const ObjectId> objects, std::uint64_t as_founder = 0,
             std::optional<SimTime> at = {});
  // Operations have given these objects to these peers, at that instant of session time or since; kNobody: nobody owns
  // them any more. One that goes to a peer that is not here is nobody's until it comes. `take_effect`: the operations
  // do so with this call.
  void give(std::span<const std::pair<ObjectId, PeerId>> given, SimTime at, bool take_effect = true);
  // This peer has entered a session, or a peer is here: operations may have given it objects before.
  void give_as_operations_say();
  // Edits have changed the scene from that instant on. Objects that are back in it are again whose they were.
  void give_back_removed(SimTime at);
  // Somebody moves the node: others go with it from now on.
  void let_move(ObjectId carrier);
  // Edits have changed the scene of the parts.
  void follow_scene();
  // A peer has gone, of which that was known.
  void lose(PeerId peer, const OtherPeer& gone, HostTime now, bool left_gracefully);
  // A far peer has said goodbye.
  void dismiss_far(PeerId peer, HostTime now);
  // A peer has gone, or begins anew: what it owned stands still from now on and belongs to nobody. An operation may
  // have said since `since` where it stands. `for_good`: not only silent; the life of its objects ends.
  void orphan_objects_of(PeerId peer, HostTime since, HostTime now, bool for_good);
  // The introduction of this peer has changed.
  void reintroduce() { p_.greeter.reintroduce(p_.own.size()); }

 private:
  void expire_members(HostTime now);
  void own_as_founder();
  void enter_session(HostTime now);
  void move_to_session_time(SimTime before, SimTime now, bool same_session);
  void begin_worlds(SimTime now);
  void declare_all();
  void watch_all_pairs();
  void take_from(PeerId before, ObjectId object);
  void follow_owners(std::span<const ObjectId> changed, SimTime at);
  void begin_owning(ObjectId object, SimTime at);
  void end_owning(ObjectId object, SimTime at);
  void leave_behind(ObjectId object, const LeftBehind& left, SimTime since);

  PeerParts& p_;
  SceneKeeper& scene_;
  // Nodes that updates name as carriers, and that cannot be: nothing rigid moves what a driven scale distorts.
  std::set<ObjectId> not_carriers_;
  // When a peer has claimed an object that was nobody's. An owner whose tick is earlier than this peer's claims by its
  // first update what an operation gives it, before that operation takes effect here.
  std::map<ObjectId, SimTime> claimed_at_;
};

}  // namespace peerd::replication
