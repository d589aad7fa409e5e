#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/scene/scene.hpp"
#include "core/shape_polygon.hpp"
#include "peerd/lab/measure/contacts_measured.hpp"
#include "peerd/lab/measure/measured.hpp"
#include "peerd/lab/measure/network_measured.hpp"

namespace peerd::measure {

// An object that some peer owns. In all of a record, times are seconds since the start of the scenario's motion, and
// events before 0 or after duration_s are left out.
struct ObjectInfo {
  ObjectId object;
  std::string path;
  PeerId owner;
};

struct PeerInfo {
  PeerId peer;
  std::string name;
  std::vector<std::pair<double, double>> there_s{};  // intervals in the session; empty: the whole run
};

// A sample of one peer's ghost of one remote object, with the truth of the same instant.
struct GhostSample {
  double t_s = 0.0;
  PeerId observer;
  ObjectId object;
  Pose truth;  // the owner's, at t_s
  Pose ghost;  // dead reckoning with prediction
  Pose shown;  // pose that a viewer draws
  Pose seen;   // displayed at the owner: the truth, unless the owner delays it too
};

struct UpdateSent {
  double t_s = 0.0;
  PeerId sender;
  ObjectId object;
  std::uint32_t bytes = 0;   // length of its record in the datagram
  double threshold_m = 0.0;  // error threshold in force
  std::string reason;        // "error", "time", "first", "joiner", "decision"
};

struct DatagramSent {
  double t_s = 0.0;
  PeerId sender;
  std::uint32_t bytes = 0;  // UDP payload
};

struct ContactRow {
  double t_s = 0.0;  // contact time
  PeerId peer;       // peer that states it
  // "owner": a contact of an object that the peer owns; "decided": a decision that it published; "predicted": a contact
  // of its ghosts; "applied": a decision of another peer that it applied; "scene": a contact of what nobody owns.
  std::string kind;
  ObjectId collider;
  ObjectId collidee;
  Vec3 normal = Vec3::Zero();
  double reported_at_s = 0.0;                    // time from which the peer knew it
  CollisionType type = CollisionType::kWitness;  // of the interest
  TouchedPolygons polygons{};                    // Shapes are named in scene_paths
};

// Whether the row is an outcome: its peer made it happen, or it happens by the world alone. Every peer finds what
// nobody owns at the same instant: their rows repeat each other.
[[nodiscard]] inline bool is_outcome(const ContactRow& row) {
  return row.kind == "owner" || row.kind == "decided" || row.kind == "scene";
}

struct WrongOutcomes {
  std::uint64_t truth = 0;     // number of outcomes without latency
  std::uint64_t missing = 0;   // true outcomes that no peer decided like this
  std::uint64_t spurious = 0;  // decided outcomes that are not true
};

// The findings of the interest oracle about one simulated peer.
struct PeerInterest {
  PeerId peer;
  double objects = 0.0;  // mean number of remote objects in its area
  std::uint64_t received_bytes =
      0;  // datagrams sent where it listened, lost ones included; without hellos and decisions
  std::uint64_t interest_bytes = 0;  // the part of all datagrams with updates that is about objects in its area
  std::uint32_t joins = 0, leaves = 0;
  std::uint32_t joins_in_a_second = 0;  // greatest number
  double groups = 0.0;                  // mean number of groups that it listened to
};
struct InterestRecord {
  double latency_ms = 0.0;           // longest delay of any link, for comparison
  double longest_missing_ms = 0.0;   // an object in an area without any state held of it
  double longest_outdated_ms = 0.0;  // an object in an area with an older state held than was sent so long before
  std::uint64_t gaps = 0;            // number of times that an object was missing
  std::uint64_t samples = 0, missing_samples = 0;
  std::vector<PeerInterest> peers;
};

// An event of the scenario, for the pictures.
struct EventMark {
  double t_s = 0.0;
  std::string name;
};

// The error of a simulated peer's session time against the peer that it followed.
struct PeerClock {
  PeerId peer;
  std::uint64_t samples = 0;
  double error_p99_ms = 0.0, error_max_ms = 0.0;
  double bound_median_ms = 0.0, bound_max_ms = 0.0;
  std::uint64_t beyond_bound = 0;
};

// How late all peers of a run with a bounded latency showed all objects, and the most by which something came after its
// bound.
struct ShownDelay {
  double least_ms = 0.0, most_ms = 0.0, latest_by_ms = 0.0;
};

// The outline of one Shape of the scene from above, for the pictures.
struct SceneOutline {
  std::optional<ObjectId> owned;         // the owned object that it is a part of; none: nobody moves it
  std::vector<Eigen::Vector2d> corners;  // world x and z [m] of a convex polygon, in order; one or two: a point, a line
  double bottom_m = 0.0, top_m = 0.0;    // its range along world y
};

// What is measured of all rows of a run, of which the record may keep only some.
struct RunMeasured {
  Measured whole;
  bool rows_complete = true;
  std::vector<Measured> parts;                                // those that the scenario has expectations of
  std::map<PeerId, std::vector<std::uint64_t>> output_bytes;  // by sender, of each second from 0 on
};

struct RunRecord {
  nlohmann::ordered_json params;  // swept and set keys, by dotted name
  // The keys of the network that are not at their defaults, by dotted name, whether or not `params` has them; empty on
  // a real network that nobody shapes.
  nlohmann::ordered_json network_settings = nlohmann::ordered_json::object();
  std::uint64_t seed = 1;
  double duration_s = 0.0;
  bool stopped = false;  // by a signal, at duration_s; or the comparison with truth was, after the run
  std::vector<PeerInfo> peers;
  std::vector<ObjectInfo> objects;              // objects with an owner, sorted by object
  std::map<ObjectId, std::string> scene_paths;  // what contacts name and nobody owns: walls, Shapes
  std::vector<SceneOutline> outlines;           // Shapes where they stand at first, those near to the objects first
  std::size_t outlines_left_out = 0;            // Shapes that `outlines` has no room for
  std::vector<GhostSample> ghost_samples;       // sorted by (observer, object, t_s)
  std::vector<UpdateSent> updates;              // sorted by t_s
  std::vector<DatagramSent> datagrams;
  std::optional<RunMeasured> measured;  // none: the three lists above are complete, and measured when asked
  std::vector<ContactRow> contacts;
  std::optional<ContactsMeasured> contacts_measured;  // none: nothing was sampled
  std::vector<EventMark> events;                      // sorted by t_s
  std::optional<WrongOutcomes> wrong;                 // none: not compared
  std::optional<InterestRecord> interest;             // none: no peer has an area of interest, or the network is real
  std::optional<NetworkMeasured> network;             // runs by netem only
  std::optional<ShownDelay> shown_delay;              // none: without a bounded latency
  std::vector<PeerClock> clocks;                      // peers that followed another; empty on a real network
  std::uint32_t groups_joined = 0;
  bool worlds_equal = true;
  std::map<std::string, std::uint64_t> counters;  // summed over the peers
};

}  // namespace peerd::measure
