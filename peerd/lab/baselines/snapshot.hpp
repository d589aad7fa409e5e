#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/kinematics.hpp"
#include "peerd/lab/baselines/command.hpp"
#include "replication/wire/smallest_three.hpp"

namespace peerd::baselines {

// An object as a server's snapshot has it, in whole steps.
struct SnapshotState {
  Steps position{};  // of kPositionStep_m
  Steps velocity{};  // of kVelocityStep_m_s
  replication::SmallestThree orientation{3, {}};
  friend bool operator==(const SnapshotState&, const SnapshotState&) = default;
};
inline constexpr double kPositionStep_m = 0x1p-10;
[[nodiscard]] SnapshotState snapshot_of(const KinematicState& state);
[[nodiscard]] KinematicState state_of(const SnapshotState& snapshot);

// A server sends its objects in blocks of so many, each as what has changed since the last snapshot of that block that
// the client has acknowledged (Quake III's delta compression).
inline constexpr std::size_t kBlockObjects = 32;
using Block = std::vector<SnapshotState>;

// Writes the objects of `now` that `base` has otherwise. Returns their indices.
std::vector<std::uint32_t> put_changes(replication::BitWriter& out, const Block& base, const Block& now);
// Reads them into a block that is the base. False: it is cut off, or names what the block does not have.
[[nodiscard]] bool take_changes(replication::BitReader& in, Block& block);

}  // namespace peerd::baselines
