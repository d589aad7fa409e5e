#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <span>

#include "replication/edits/log/operation_exchange.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/scene/living_scene.hpp"
#include "replication/objects/contacts/contact_decisions.hpp"
#include "replication/objects/contacts/decision_check.hpp"
#include "replication/objects/ghosts/ghost_check.hpp"
#include "replication/objects/regions/region_subscriptions.hpp"
#include "replication/objects/replica/display.hpp"
#include "replication/objects/replica/launches.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/objects/replica/replica.hpp"
#include "replication/objects/replica/scene_objects.hpp"
#include "replication/objects/replica/scripted_motion.hpp"
#include "replication/objects/sight/sight.hpp"
#include "replication/objects/updates/publication.hpp"
#include "replication/session/admission.hpp"
#include "replication/session/greeter.hpp"
#include "replication/session/member_limits.hpp"
#include "replication/session/membership.hpp"
#include "replication/session/presence.hpp"
#include "replication/session/session_time.hpp"
#include "replication/session/world_time.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/output/tick_grid.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::replication {

// The owner that an object had when an operation removed it. If an undo brings it back, peers that have received both
// at once have never seen it gone, and all others go on as those do.
struct RemovedObject {
  PeerId owner;
  bool as_founder = false;
  SimTime decided{};  // a decision of that contact time has lent it to its owner; SimTime{}: none has
};

// An object whose owner is gone: whose it was, when this peer noticed that, and whether it received the object, and so
// may know where it stood.
struct LeftBehind {
  PeerId owner;
  SimTime at{};
  bool was_received = true;
};

// The parts of a peer. Each owns its fields and knows those above it in this list, which is the order of the rooms;
// SessionKeeper, contact_report and Intake do what concerns several of them.
struct PeerParts {
  PeerParts(PeerConfig peer_config, const WorldModel& world_model);
  PeerParts(const PeerParts&) = delete;
  PeerParts& operator=(const PeerParts&) = delete;

  PeerConfig config;  // look_from() alone changes it
  // The objects that configurations or the file give to peers, ascending; of the model that this peer was given.
  const std::vector<ObjectId>& configured;
  ModelInForce model;
  // The operations that all peers have made, and what they make of the scene. The model begins with what is stored.
  const AuthorId author;  // of this peer's own
  OperationLogs logs;
  LivingScene living;          // of what logs have
  const SimTime stored_until;  // the stamp of the last operation that its store had; min(): there was none
  PeerCounters counters;
  TickGrid ticks;
  Outbox outbox;
  // The peers that are here, and session time.
  Membership members;
  MemberLimits limits;
  Admission admission;
  SessionTime time;
  WorldTime world_time;
  Greeter greeter;
  OperationExchange exchange;  // of the logs
  // The world, as far as this peer knows it.
  Presence presence;
  Owners owners;
  std::map<ObjectId, LeftBehind> left_behind;  // no operation says yet where these stand
  SimTime resting_followed = SimTime::min();   // the half second in which follow_resting_ghosts() has looked
  std::map<ObjectId, RemovedObject> removed;
  OwnObjects own;
  SceneObjects scene;
  Replica replica;
  ScriptedMotion scripted;
  Launches launches;
  Display display;
  Sight sight;
  // Regions, decisions on contacts, and updates.
  RegionSubscriptions regions;
  ContactDecisions decisions;
  DecisionCheck decision_check;
  GhostCheck ghost_check;
  Publication publication;

  // Session time of `now`.
  [[nodiscard]] SimTime to_session(HostTime now) const { return time.clock().to_session(now); }
  // Counts a record of a member that was not used.
  void drop(PeerId sender, const char* reason);
  // Gives both worlds, which have begun, the motion by the file until t, and the truth the launches by this peer until
  // then.
  void extend_motions(SimTime t);
  // Advances both worlds to t, an instant before the next tick, or of it.
  void advance_worlds(SimTime t);
  // Moves a remote object in the truth to its ghost, once both have kept their law for a second and two latencies, in
  // which every decision on them has arrived. Called at each tick; checks twice a second.
  void follow_resting_ghosts(SimTime t);
  void return_fallen(SimTime t);
  // The instant to which both worlds have been advanced.
  [[nodiscard]] SimTime reached() const { return std::min(replica.truth().advanced(), replica.ghosts().advanced()); }
  // These objects are moved by somebody from now on, or others relative to them: the model in force has them as
  // carriers from now on. Returns whether that makes another model of it; then all of its pairs are to be watched anew.
  [[nodiscard]] bool let_move(std::span<const ObjectId> objects);
  // Edits have made that scene of this peer's, from `at` on, up to which both worlds have been advanced and their
  // events polled. All pairs are to be watched anew. Own objects that go on do so wherever the scene places them now.
  void change_scene(std::shared_ptr<const Scene> edited_scene, SimTime at, const std::set<ObjectId>& going_on = {},
                    std::span<const SetField> fields = {});
  // Whether the object answers contacts where nobody owns it: the same at all peers that know the same operations,
  // whatever they have seen of it.
  [[nodiscard]] bool is_scene_object(const WorldModel& of, ObjectId object) const;
  // Nobody owns some objects any more, or the model in force is of an edited scene since then: what answers contacts is
  // among the scene objects. Returns those that are new.
  std::vector<ObjectId> follow_scene_objects(SimTime since);
  // The pose that the scene gives the object, in the frame of its carrier.
  [[nodiscard]] Pose place_by_scene(ObjectId object) const;
  // The world's velocityVector of an object, which is in its parent's frame, in the world's frame [m/s].
  [[nodiscard]] Vec3 file_velocity(SimTime at, ObjectId object);
  // A velocity relative to the object's carrier, from the frame of its parent, as the file has it, turned to the world.
  [[nodiscard]] Vec3 velocity_in_world(SimTime at, ObjectId object, const Vec3& in_parent);
  // The decisions and the truth watch these pairs of the model by who owns and receives their objects now.
  void watch_pairs_of(ObjectId object) { decisions.watch().follow(object); }
  // These objects have an owner from now on, or none any more: that matters to their pairs, and to those of what they
  // are paired with.
  void watch_pairs_around(std::span<const ObjectId> objects);
  // A decision on a contact of that time makes the peer the owner of the scene object.
  void give_scene_object(ObjectId object, PeerId owner, SimTime decided);
  void forget_what_is_gone(const Scene& next);
  // The place and the velocityVector of an object by the scene, and whether an edit sets them.
  struct Begin {
    Pose place;
    Vec3 velocity;
    bool place_is_set, velocity_is_set;  // also to the same value
  };
  [[nodiscard]] Begin begin_by_scene(ObjectId object, std::span<const SetField> fields) const;
  void begin_own_anew(ObjectId object, SimTime at, const Begin& before);
  void stand_by_scene(ObjectId object, SimTime at);
  void give_velocity(ObjectId object, SimTime at, const Begin& before);
  // kNobody: it is nobody's from now on.
  void set_owner_of_scene_object(ObjectId object, PeerId owner, PeerId before);
};

}  // namespace peerd::replication
