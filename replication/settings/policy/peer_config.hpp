#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/convergence.hpp"
#include "replication/settings/grid/interest.hpp"
#include "replication/settings/policy/bounded_latency.hpp"
#include "replication/settings/policy/large_session.hpp"
#include "replication/settings/policy/publish_policy.hpp"
#include "replication/settings/policy/rare_branches.hpp"
#include "replication/wire/decision_policy.hpp"
#include "replication/wire/operation.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

class LogSigner;
class TickDetection;

// The way in which an object that nothing drives begins to move; from then on physics moves it.
struct Launch {
  Duration after{0};                     // counted from the start of motions
  std::optional<Vec3> velocity;          // [m/s], world frame; none: the velocityVector of the world's file
  std::optional<Vec3> acceleration;      // [m/s^2], world frame. It stays through bounces; none: the world's gravity
  Vec3 angular_velocity = Vec3::Zero();  // [rad/s], world frame, at the launch; the body keeps it
};

// An object that this peer owns. A driven one is moved by samples that come with each tick; the others move by their
// launch and respond to contacts.
struct OwnedObject {
  ObjectId object;
  bool driven = false;
  Launch launch = {};
};

// The settings by which collisions between objects of two peers are decided. All peers of a session should have the
// same.
struct DecisionSettings {
  DecisionPolicy policy = DecisionPolicy::kId;
  PeerId server = kNobody;             // the decider by kServer
  std::optional<Duration> lookback;    // none: the longest latency that any peer publishes
  bool repeat = true;                  // repeats decisions until all peers have acknowledged them
  bool fallback = true;                // the lower id decides contacts on which no other peer has said anything
  std::optional<Viewpoint> viewpoint;  // the viewpoint of this peer
};

// For baselines: a peer through which all states go, as through a central server. Other peers ignore updates of an
// object from any other sender; hellos and decisions go to all peers as always.
struct RelaySettings {
  PeerId through = kNobody;
  // Relayed updates count from when the relay received them, as on a server without lag compensation.
  bool restamps = false;
};

// The delay with which objects are displayed: `fixed`, and, if `measured`, the age of the oldest update so far and the
// interval between snapshots besides, so that nothing has to be extrapolated. It applies to remote objects; also to
// own ones if `own`, as in lockstep, where a user's input takes effect for all at once.
struct DisplayDelay {
  Duration fixed{0};
  bool measured = false;
  bool own = false;
};

// What a viewpoint of this peer sees: to a distance, where that is finite.
struct View {
  Viewpoint viewpoint;
  double far_m = std::numeric_limits<double>::infinity();
};

// Whether contacts of other peers' objects that no view shows are left to their updates (replication/objects/sight),
// and what the views are at first.
struct SightSettings {
  bool skip_unseen = false;
  std::vector<View> views;
};

// The logs of all authors, as far as a store has them, or the peers of a session whose world this peer got.
struct StoredLogs {
  // Whole operations, each log from its beginning and in order. The peer begins with the scene that these make.
  std::vector<OperationPart> parts;
  std::uint64_t line = 0;        // of descent (LineOfDescent), also without any part
  bool is_of_a_session = false;  // peers that are in one have given it
};

struct PeerConfig {
  PeerId id{1};
  std::string name;
  std::uint64_t incarnation = 1;  // must grow from one start of this peer to the next
  std::uint64_t world_hash = 0;   // peers with another world are ignored, and reported once
  // The author of this peer's operations: that of its store. None: an author of this start alone.
  std::optional<AuthorId> author;
  StoredLogs log;
  const LogSigner* signer = nullptr;  // of operations, which outlives the peer: OperationLogs
  std::vector<OwnedObject> owned;
  // Objects that the world's file gives to the founder of the session: this peer owns them from when it founds one. A
  // peer that owns such an object by its `owned` comes before a founder.
  std::vector<OwnedObject> owned_by_founder;
  PublishPolicy policy;
  ConvergencePolicy convergence;
  // The nodes that the world's file marks as `remote` converge in this way.
  ConvergencePolicy remote_convergence{ConvergenceMethod::kParabola};
  DecisionSettings decisions;
  RelaySettings relay;
  DisplayDelay display_delay;
  BoundedLatency bounded_latency;  // where it is on, display_delay and convergence do not count
  RegionSettings regions;
  LargeSession large;
  SightSettings sight;
  // This peer receives, where the scene is cut into regions, what is so near [m] to its viewpoint, or, where it has
  // none, to an object that it owns; and what these could collide with. None: it receives everything.
  std::optional<double> interest_radius_m;
  std::uint32_t tick_hz = 60;
  // Finds contacts at ticks in place of contact times: for baselines. This peer's own, and of the same engine and rate
  // at all peers of a session, which world_hash includes.
  std::shared_ptr<TickDetection> detection;
  Duration hello_period = std::chrono::milliseconds(250);
  // The hello period once no other peer waits for a hello; between two of them goes a datagram that says only that
  // this peer is here.
  Duration settled_hello_period = std::chrono::milliseconds(1000);
  Duration lost_after = std::chrono::milliseconds(1750);    // seven hellos; within the 2 s that users are promised
  Duration listen_first = std::chrono::milliseconds(1000);  // before founding a session of one's own
  // How far other members may move this peer's session time ahead of its own clocks (ClockReach), > 0.
  Duration clock_ahead_max = std::chrono::minutes(10);
  // Whether this peer may take an object without asking its owner (Peer::steal()). The same at all peers of a session.
  bool may_steal = false;
  RareBranches rare;
  // Objects that nothing drives stand until start_motions(); otherwise their launches count from the beginning of the
  // session.
  bool wait_for_start = false;

  // Whether this peer decides all contacts of two owners.
  [[nodiscard]] bool is_decision_server() const {
    return decisions.policy == DecisionPolicy::kServer && decisions.server == id;
  }
};

}  // namespace peerd::replication
