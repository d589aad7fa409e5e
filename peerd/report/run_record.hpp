#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"

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
};

// What one peer believed of one remote object at one of its ticks.
struct BeliefSample {
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

struct RunRecord {
  nlohmann::ordered_json params;  // every swept key by its dotted name
  double duration_s = 0.0;
  std::vector<PeerInfo> peers;
  std::vector<ObjectInfo> objects;              // the replicated ones
  std::map<ObjectId, std::string> scene_paths;  // of what nobody runs but contacts name: walls
  std::vector<BeliefSample> beliefs;            // sorted by (observer, object, t_s)
  std::vector<UpdateSent> updates;              // sorted by t_s
  std::vector<DatagramSent> datagrams;
  std::vector<ContactRow> contacts;
  std::optional<WrongOutcomes> wrong;  // none: not compared
  std::uint32_t groups_joined = 0;
  bool worlds_equal = true;
  std::map<std::string, std::uint64_t> counters;  // summed over the peers
};

}  // namespace peerd::report
