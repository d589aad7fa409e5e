#pragma once
#include <cstddef>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/edits/log/operation_exchange.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/scene/conflicts.hpp"
#include "replication/edits/scene/locks.hpp"
#include "replication/edits/scene/node_data.hpp"
#include "replication/objects/replica/own_sample.hpp"
#include "replication/objects/replica/owners.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/physics/world/world_model.hpp"
#include "replication/session/membership.hpp"
#include "replication/session/session_clock.hpp"
#include "replication/settings/output/output.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A whole peer: replica, dead reckoning, prediction, decisions, session. It is sans-IO: it owns no socket, clock,
// thread or source of randomness. `now` is this host's clock and must not run backwards. Single-threaded.
class Peer {
 public:
  using Counters = PeerCounters;

  // The model outlives the peer.
  Peer(PeerConfig config, const WorldModel& model);
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer();

  // ---- the driver's calls; poll_output() is to be drained after each that takes `now`
  // A datagram from the network, which is hostile. The error says why it changed nothing.
  std::expected<void, Drop> on_packet(HostTime now, RegionId region, std::span<const std::byte> datagram);
  // Does everything that is due at `now`; calling it early is harmless. `samples` are of the instant that due_tick(now)
  // gave, one for each driven object, and are ignored when no tick is due.
  void on_tick(HostTime now, std::span<const OwnSample> samples);
  // The tick that on_tick(now) would do: the last point of the session's tick grid that is not after now. None: not
  // due, or not synchronised yet.
  [[nodiscard]] std::optional<SimTime> due_tick(HostTime now) const;
  // Between two ticks: what drives these objects has just moved them. Each whose ghosts are too wrong is published now
  // and not with the next tick, once at most until then; so is what change_velocity() has changed. Does nothing where a
  // tick is due, which publishes them. Samples are of `now`, with derivatives.
  void publish_now(HostTime now, std::span<const OwnSample> samples);
  // The operating system's statement on this host's clock at `now`, for the preference of good ones; none: it has none.
  void on_os_clock(HostTime now, std::optional<OsClock> clock);
  // The launches of own objects count from `start`, or from now if that has passed.
  void start_motions(HostTime now, SimTime start);
  // A key or a hand changes the velocity [m/s, world frame] of an object that this peer owns and nothing drives:
  // replaces it, or adds to it. False, and nothing done, for any other object and before a session. publish_now() or
  // the next tick publishes it.
  bool change_velocity(HostTime now, ObjectId object, const Vec3& velocity, bool absolute);
  // From now on samples move an own object, as those that PeerConfig says are driven. False: it is no own one.
  bool begin_driving(HostTime now, ObjectId object);
  // What drove it lets go of it in that state in the world; physics moves it from there. Published as a velocity is.
  void end_driving(HostTime now, ObjectId object, const KinematicState& state);
  // This peer's hellos say from now on when motions by formula begin. Peers that run such motions together follow the
  // peer with the lowest id. The time is also time 0 of the world's TimeSensors where the session has none yet.
  void announce_start(SimTime start);
  // The bytes of a log, as far as this peer has them without a gap: of LogGrown, all.
  [[nodiscard]] std::vector<std::byte> log_bytes(const OperationRange& range) const;
  // Changes the scene, for all peers and for good, from an instant on that leaves all of them the time to know it. The
  // peer chooses the ids of what the operation adds, and resolves names of its text that the text does not have. The
  // error says, for people, why it cannot be. SceneEdited says what has become of it, OperationHeld that it outlives
  // this peer.
  std::expected<OperationId, std::string> edit(HostTime now, OperationBody body);
  // This peer owns the object from the stamp on, if nobody who is here does, or if it `steals` (PeerConfig::may_steal);
  // else it asks the owner, who sees ObjectRequested. ObjectGiven or RequestRefused says what has become of it.
  std::expected<Taking, std::string> own(HostTime now, ObjectId object, bool steals = false);
  // Gives an object to another peer, or, kNobody, to nobody: then it stands where it is or, if it answers contacts,
  // goes on as it moves.
  std::expected<OperationId, std::string> give(HostTime now, ObjectId object, PeerId to);
  // Undoes the last edit of this author that it has not undone, or redoes the one that it has undone last, by another
  // operation; what others have overwritten is passed over. The error says why there is none.
  std::expected<UndoneEdit, std::string> undo(HostTime now, bool redoes);
  void follow_writers();     // some may do more than they might (LogSigner::writer())
  void leave(HostTime now);  // says goodbye; the peer is over after this

  [[nodiscard]] std::optional<Output> poll_output();
  // Takes back the memory of a datagram that has been sent, so that sending need not allocate.
  void reuse(Bytes&& datagram);
  [[nodiscard]] HostTime next_deadline() const;  // the time at which to call on_tick() next

  // ---- what this peer knows
  [[nodiscard]] PeerId id() const;
  [[nodiscard]] const PeerConfig& config() const;  // with the viewpoint that it has now
  [[nodiscard]] const Scene& scene() const;        // as all operations until the last tick have made it
  [[nodiscard]] const WorldModel& model() const;   // of that scene
  [[nodiscard]] const NodeData& data() const;      // of applications at its nodes
  [[nodiscard]] std::vector<Lock> locks() const;   // all that are in force
  [[nodiscard]] std::optional<Lock> lock_around(ObjectId object) const;  // its own, or the nearest one's above it
  // The losses of operations by others that did not know them, and an operation; none: it is not known.
  [[nodiscard]] const Conflicts& conflicts() const;
  [[nodiscard]] std::optional<OperationBody> find(const OperationKey& operation) const;
  [[nodiscard]] const SessionClock& clock() const;
  [[nodiscard]] const std::optional<OsClock>& os_clock() const;
  [[nodiscard]] OffsetBounds clock_reach(HostTime now) const;  // others may move session time so far, back and ahead
  // The peer whose session time this one takes over; itself: it leads. None: nobody's yet.
  [[nodiscard]] std::optional<PeerId> follows() const;
  [[nodiscard]] const Membership& members() const;
  [[nodiscard]] PeerId owner(ObjectId object) const { return owners().of(object); }
  [[nodiscard]] const Owners& owners() const;
  [[nodiscard]] bool owns_any() const;                                     // this peer
  [[nodiscard]] std::optional<double> threshold_m(ObjectId object) const;  // [m]; none: not own, or not checked yet
  // Session time at which the world's TimeSensors began, the same on all peers; none until one of them has said.
  [[nodiscard]] std::optional<SimTime> world_zero() const;
  [[nodiscard]] std::optional<double> time_sensors_limited_at() const;  // they stand still from then on, world time [s]
  // A vector in the frame of the object's parent, as files have it, in the world's, as the parent stands then.
  [[nodiscard]] Vec3 to_world(SimTime at, ObjectId object, const Vec3& in_parent);

  // The state of an object as this peer knows it, and as all peers predict it. Both need a session. Of the past 4 s; of
  // own ones that are driven of half a second, or, if no interest names them, of the last sample, unless shown late.
  [[nodiscard]] KinematicState truth(ObjectId object, SimTime t) const;
  [[nodiscard]] KinematicState ghost(ObjectId object, SimTime t) const;
  // Whether this peer listens to the object's region. What it says of others is void; they meet nothing here.
  [[nodiscard]] bool receives(ObjectId object) const;
  [[nodiscard]] const UpdateRecord* last_update_of(ObjectId object) const;  // applied, of a remote one; null: none
  [[nodiscard]] const Interest& interest() const;
  // Brings the ghosts to t, which may lie between two ticks, for a viewer's frame. Other peers can't notice it.
  void advance_ghosts(SimTime t);
  // From now on this peer sees so (SightSettings): the views of a viewer, before the advance_ghosts() of its frame;
  void look(std::vector<View> views);
  void look_from(const std::optional<Viewpoint>& viewpoint);  // .. and has that viewpoint, as all others hear
  // What a viewer draws after advance_ghosts(t); t never goes back. It goes through nothing that the ghost didn't.
  [[nodiscard]] Pose shown(ObjectId object, SimTime t);
  [[nodiscard]] std::optional<double> ghost_difference_m(ObjectId object, HostTime now) const;  // GhostCheck
  void displace_ghost(ObjectId object, SimTime t, const Vec3& by_m);  // for tests: a difference from t on
  [[nodiscard]] std::optional<Duration> bound(SimTime t);  // of BoundedLatency, at about now; none: without that mode

  [[nodiscard]] const Counters& counters() const;
  [[nodiscard]] const OperationLogs& logs() const;  // of all authors, as far as this peer holds them
  [[nodiscard]] OperationExchange::Counters exchange_counters() const;
  [[nodiscard]] MotionWorld::Counters motion_counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace peerd::replication
