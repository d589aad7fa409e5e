#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "peerd/measure/network_measured.hpp"

namespace peerd::report {

// Everything that is known of one run, whichever driver made it. Times are seconds since the start of the scenario's
// motion; what happened before 0 or after duration_s is not in it.
struct ObjectInfo {
  ObjectId object;
  std::string path;
  PeerId owner;
};

struct PeerInfo {
  PeerId peer;
  std::string name;
  std::vector<std::pair<double, double>> there_s{};  // from when to when; empty: all the time
};

// What one peer believed of one remote object at one of its ticks.
struct GhostSample {
  double t_s = 0.0;
  PeerId observer;
  ObjectId object;
  Pose truth;  // the owner's, at t_s
  Pose ghost;  // dead reckoning with prediction
  Pose shown;  // what a viewer draws
  Pose seen;   // what a viewer at its owner draws then: the truth, unless input is delayed there
};

struct UpdateSent {
  double t_s = 0.0;
  PeerId sender;
  ObjectId object;
  std::uint32_t bytes = 0;   // of its record in the datagram
  double threshold_m = 0.0;  // the error threshold in force
  std::string reason;        // "error", "time", "first", "joiner", "decision"
};

struct DatagramSent {
  double t_s = 0.0;
  PeerId sender;
  std::uint32_t bytes = 0;  // UDP payload
};

struct ContactRow {
  double t_s = 0.0;  // contact time
  PeerId peer;       // who says so
  std::string kind;  // "owner": happened to an object that it runs; "decided": sent as a decision;
                     // "predicted": on its ghosts; "applied": a decision that it took over
  ObjectId collider;
  ObjectId collidee;
  Vec3 normal = Vec3::Zero();
  double reported_at_s = 0.0;  // when the peer knew
};

struct WrongOutcomes {
  std::uint64_t truth = 0;     // outcomes without latency
  std::uint64_t missing = 0;   // of those, which nobody decided so
  std::uint64_t spurious = 0;  // decided, and not true
};

// What a simulated peer heard of what was in its area of interest, as somebody found who sees everything.
struct PeerInterest {
  PeerId peer;
  double objects = 0.0;              // others' objects in its area, on average
  std::uint64_t received_bytes = 0;  // that came its way but hellos and decisions, lost datagrams included
  std::uint64_t interest_bytes = 0;  // of all with updates, the part that told of objects while in its area
  std::uint32_t joins = 0, leaves = 0;
  std::uint32_t joins_in_a_second = 0;  // at most
  double groups = 0.0;                  // that it listened to, on average
};
struct InterestRecord {
  double latency_ms = 0.0;           // the longest of any link, for comparison
  double longest_missing_ms = 0.0;   // an object in an area, of which that peer held nothing
  double longest_outdated_ms = 0.0;  // .. of which it did not hold what had been told of it so long before
  std::uint64_t gaps = 0;            // how often an object was missing
  std::uint64_t samples = 0, missing_samples = 0;
  std::vector<PeerInterest> peers;
};

// Something that the scenario had happen, for the pictures.
struct EventMark {
  double t_s = 0.0;
  std::string name;
};

// Of a simulated peer's session time, against the peer that it followed.
struct PeerClock {
  PeerId peer;
  std::uint64_t samples = 0;
  double error_p99_ms = 0.0, error_max_ms = 0.0;
  double bound_median_ms = 0.0, bound_max_ms = 0.0;
  std::uint64_t beyond_bound = 0;
};

struct RunRecord {
  nlohmann::ordered_json params;  // every swept key by its dotted name
  std::uint64_t seed = 1;
  double duration_s = 0.0;
  std::vector<PeerInfo> peers;
  std::vector<ObjectInfo> objects;              // the replicated ones
  std::map<ObjectId, std::string> scene_paths;  // of what nobody runs but contacts name: walls
  std::vector<GhostSample> ghost_samples;       // sorted by (observer, object, t_s)
  std::vector<UpdateSent> updates;              // sorted by t_s
  std::vector<DatagramSent> datagrams;
  std::vector<ContactRow> contacts;
  std::vector<EventMark> events;           // sorted by t_s
  std::optional<WrongOutcomes> wrong;      // none: not compared
  std::optional<InterestRecord> interest;  // none: nobody has an area of interest, or a real network
  std::optional<NetworkMeasured> network;  // of a run by netem
  std::vector<PeerClock> clocks;           // of those that followed another; empty on a real network
  std::uint32_t groups_joined = 0;
  bool worlds_equal = true;
  std::map<std::string, std::uint64_t> counters;  // summed over the peers
};

}  // namespace peerd::report
