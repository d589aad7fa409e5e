#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd {

// What one peer did and believed in a run, or in one of its lives where it left and came back, in session time. The
// simulator keeps it in memory, a real peer writes it to a file; peerd/scenario/assemble.hpp makes one RunRecord of all of them.
struct PeerLog {
  // `at` is a tick of the peer's own session clock, `true_at` the same instant on a clock that all peers share (the
  // simulator's, or the computer's without the test offset): what an error of the session clock hides, that one shows.
  struct ObjectSample {
    SimTime at;
    HostTime true_at;
    ObjectId object;
    PeerId owner;  // the peer itself: `state` is the truth
    KinematicState state;
    Pose shown{};  // what a viewer draws
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
  };

  // Of a simulated peer's session time, against the peer that it followed: as somebody found who sees both clocks.
  struct ClockError {
    std::uint64_t samples;  // ticks
    Duration p99, max;
    Duration bound_median, bound_max;  // that it published
    std::uint64_t beyond_bound;        // samples in which the error was larger
  };

  PeerId peer;
  std::string name;
  std::optional<SimTime> start;      // of the motions
  std::optional<HostTime> ended_at;  // when it left or was killed, like `true_at`; none: it was there to the end
  std::vector<ObjectSample> object_samples;
  std::vector<Update> updates;
  std::vector<Datagram> datagrams;
  std::vector<Contact> contacts;
  std::uint32_t groups_joined = 0;
  std::uint32_t other_worlds = 0;
  std::map<std::string, std::uint64_t> counters;
  std::optional<ClockError> clock_error;  // none: it led all the time, or a real network; not in the file
};

[[nodiscard]] Result<void> save(const PeerLog& log, const std::filesystem::path& path);
[[nodiscard]] Result<PeerLog> load_peer_log(const std::filesystem::path& path);

}  // namespace peerd
