#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "peerd/motion/drive.hpp"
#include "peerd/motion/flock.hpp"
#include "peerd/motion/motion_formula.hpp"
#include "peerd/input/toml_input.hpp"
#include "peerd/motion/track.hpp"
#include "peerd/motion/walk.hpp"
#include "peerd/motion/waypoints.hpp"
#include "replication/policy/peer_config.hpp"

namespace peerd::config {

// Samples come from a program, while the peer runs.
struct ExternalProgram {};

// A table [motion.PATTERN] or [peer.NAME.motion.OBJECT]: one way to move the objects that it names. It stands for
// whatever moves an object in earnest (a hand, a vehicle model, a motion capture): it hands out samples, and
// replication never sees what is behind them.
struct MotionSettings {
  std::string at;  // FILE:LINE:COLUMN: of the table; empty where none is known
  std::variant<MotionFormula, Waypoints, Track, WalkSettings, DriveSettings, FlockSettings, ExternalProgram,
               replication::Launch>
      kind;
  bool face_forward = false;          // of all but formulas: look along the velocity
  bool hold_before_start = false;     // stand at the pose of t = 0 until then, instead of being under way
  std::optional<std::uint64_t> seed;  // of what is random; none: the scenario's
};

// `folder` is the scenario's, which a track's file is relative to.
[[nodiscard]] MotionSettings read_motion(TomlReader reader, const std::filesystem::path& folder);

}  // namespace peerd::config
