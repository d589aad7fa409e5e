#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/motion/convergence.hpp"
#include "replication/interest/interest.hpp"
#include "replication/policy/publish_policy.hpp"
#include "replication/wire/decision_policy.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// How an object that nothing drives begins to move; from then on physics moves it.
struct Launch {
  Duration after{0};                 // the start of motions
  std::optional<Vec3> velocity;      // [m/s], world frame; none: the world's velocityVector
  Vec3 acceleration = Vec3::Zero();  // [m/s^2], world frame: gravity. It stays through bounces
};

// An object that this peer runs. A driven one is moved by samples that come with each tick; the others move by their
// launch and answer their contacts.
struct OwnedObject {
  ObjectId object;
  bool driven = false;
  Launch launch = {};
};

// How collisions between objects of two peers are decided. All peers of a session should say the same.
struct DecisionSettings {
  DecisionPolicy policy = DecisionPolicy::kId;
  PeerId server = kNobody;             // decides all by kServer
  std::optional<Duration> lookback;    // none: the longest latency that any peer says it hears others with
  bool repeat = true;                  // until everybody has them, by their receipts
  bool fallback = true;                // the lower id decides what nobody else has said a word about
  std::optional<Viewpoint> viewpoint;  // of this peer
};

// For the baselines of others: a peer through which all states go, as a central server has it. Who hears of an object
// from anybody else takes no notice; hellos and decisions go to everybody as always.
struct RelaySettings {
  PeerId through = kNobody;
  // What is passed on counts from when the relay heard it, as a server without lag compensation has it.
  bool restamps = false;
};

// How late objects are shown: by `fixed`, and, if `measured`, by the age of the oldest update so far and the interval
// between snapshots besides, so that nothing has to be extrapolated. Others' objects; own ones as well if `own`, as in
// lockstep, where a user's input takes effect for everybody at once.
struct DisplayDelay {
  Duration fixed{0};
  bool measured = false;
  bool own = false;
};

struct PeerConfig {
  PeerId id{1};
  std::string name;
  std::uint64_t incarnation = 1;        // must grow from one start of this peer to the next
  std::uint64_t world_hash = 0;  // peers with another world are ignored, and named once
  std::vector<OwnedObject> owned;
  PublishPolicy policy;
  ConvergencePolicy convergence;
  DecisionSettings decisions;
  RelaySettings relay;
  DisplayDelay display_delay;
  RegionSettings regions;
  // Where the scene is cut into regions, this peer hears of what is so near to its viewpoint, or, where it has none, to
  // an object that it runs; and of what these could collide with. None: of everything.
  std::optional<double> interest_radius_m;
  std::uint32_t tick_hz = 60;
  Duration hello_period = std::chrono::milliseconds(250);
  // .. once there is nothing that the others wait for; between them, a datagram that says only that this peer is here.
  Duration settled_hello_period = std::chrono::milliseconds(1000);
  Duration lost_after = std::chrono::milliseconds(1750);    // seven hellos; within the 2 s that users are promised
  Duration listen_first = std::chrono::milliseconds(1000);  // before founding a session of one's own
  // Objects that nothing drives stand until start_motions(); else their launches count from the session's begin.
  bool wait_for_start = false;

  // Whether this peer decides all contacts of two owners.
  [[nodiscard]] bool is_decision_server() const {
    return decisions.policy == DecisionPolicy::kServer && decisions.server == id;
  }
};

}  // namespace peerd::replication
