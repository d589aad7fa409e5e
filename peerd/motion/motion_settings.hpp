#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "peerd/input/toml_input.hpp"
#include "peerd/motion/drive.hpp"
#include "peerd/motion/flock.hpp"
#include "peerd/motion/motion_formula.hpp"
#include "peerd/motion/track.hpp"
#include "peerd/motion/walk.hpp"
#include "peerd/motion/waypoints.hpp"
#include "replication/policy/peer_config.hpp"

namespace peerd::config {

// An external program sends the samples while the peer runs.
struct ExternalProgram {};

// A table [motion.PATTERN] or [peer.NAME.motion.OBJECT]: one way to move the objects that it names. It stands for
// whatever moves an object in earnest (a hand, a vehicle model, a motion capture): it gives samples, and replication
// never sees how they are made.
struct MotionSettings {
  std::string at;  // FILE:LINE:COLUMN: of the table; empty: unknown
  std::variant<MotionFormula, Waypoints, Track, WalkSettings, DriveSettings, FlockSettings, ExternalProgram,
               replication::Launch>
      kind;
  bool face_forward = false;          // look along the velocity; not for formulas
  bool hold_before_start = false;     // stand at the pose of t = 0 before the start
  std::optional<std::uint64_t> seed;  // seed of the random generator; none: the scenario's
};

// `folder` is the scenario's folder, which a track's file name starts from.
[[nodiscard]] MotionSettings read_motion(TomlReader reader, const std::filesystem::path& folder);

}  // namespace peerd::config
