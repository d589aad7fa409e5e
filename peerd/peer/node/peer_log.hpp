#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "core/shape_polygon.hpp"
#include "core/time.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd {

// Everything that one peer did and believed in a run, in session time; a peer that left and came back has one log for
// each of its incarnations. The simulator keeps logs in memory and a real peer writes its log to a file;
// peerd/lab/live/assemble.hpp makes one RunRecord of all of them.
struct PeerLog {
  // `at` is a tick of the peer's own session clock and `true_at` the same instant on a clock that all peers share (the
  // simulator's, or the computer's without the test offset). The shared clock shows what an error of the session clock
  // would hide.
  struct ObjectSample {
    SimTime at;
    HostTime true_at;
    ObjectId object;
    PeerId owner;  // where this is the peer itself, `state` is the truth
    KinematicState state;
    Pose shown{};  // as a viewer draws it
  };
  struct Update {
    SimTime at;
    ObjectId object;
    std::uint32_t bytes;
    double threshold_m;
    std::string reason;
  };
  struct Datagram {
    SimTime at;
    std::uint32_t bytes;
  };
  struct Contact {
    SimTime at;
    std::string kind;
    ObjectId collider, collidee;
    Vec3 normal;
    SimTime known_at;
    CollisionType type = CollisionType::kWitness;  // of the interest
    TouchedPolygons polygons{};
  };

  // The error of a simulated peer's session time against that of the peer that it followed. The simulator measures it,
  // since it sees both clocks.
  struct ClockError {
    std::uint64_t samples;  // ticks
    Duration p99, max;
    Duration bound_median, bound_max;  // bounds that the peer published
    std::uint64_t beyond_bound;        // samples with an error beyond the published bound
  };

  // The bounds that were in force at the samples, and the most by which something came after its own (BoundedLatency).
  struct Bound {
    Duration least, most, latest_by;
  };

  PeerId peer;
  std::string name;
  std::optional<SimTime> start;      // of the motions
  std::optional<HostTime> ended_at;  // when the peer left or was killed, as `true_at`; none: it stayed to the end
  std::vector<ObjectSample> object_samples;
  std::vector<Update> updates;
  std::vector<Datagram> datagrams;
  std::vector<Contact> contacts;
  std::map<ObjectId, std::string> paths;  // of objects in these rows that the world's file does not have
  std::uint32_t groups_joined = 0;
  std::uint32_t other_worlds = 0;
  std::map<std::string, std::uint64_t> counters;
  std::optional<Bound> bound;             // none: without that mode, or before the first sample
  std::optional<ClockError> clock_error;  // not in the file; none: a real network, or the peer led all the time
};

// Takes the rows of the logs of one run as they come, in place of the lists of the logs, which grow with the run.
class LogRows {
 public:
  virtual ~LogRows() = default;

  // A life of the peer begins, or has ended at that true time.
  virtual void enter(const PeerLog& log) = 0;
  virtual void end(PeerId peer, HostTime ended_at) = 0;
  // Rows of the peer's present life. Object samples come in order of `true_at` but for what a clock is corrected by.
  virtual void add(const PeerLog& log, const PeerLog::ObjectSample& sample) = 0;
  virtual void add(const PeerLog& log, PeerLog::Update update) = 0;
  virtual void add(const PeerLog& log, const PeerLog::Datagram& datagram) = 0;
};

[[nodiscard]] Result<void> save(const PeerLog& log, const std::filesystem::path& path);
[[nodiscard]] Result<PeerLog> load_peer_log(const std::filesystem::path& path);

}  // namespace peerd
