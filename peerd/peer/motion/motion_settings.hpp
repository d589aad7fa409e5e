#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "peerd/input/toml_input.hpp"
#include "peerd/peer/motion/drive.hpp"
#include "peerd/peer/motion/flock.hpp"
#include "peerd/peer/motion/motion_formula.hpp"
#include "peerd/peer/motion/track.hpp"
#include "peerd/peer/motion/walk.hpp"
#include "peerd/peer/motion/waypoints.hpp"
#include "replication/settings/policy/peer_config.hpp"

namespace peerd::motion {

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

}  // namespace peerd::motion
