#pragma once
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "collision/broad_phase/broad_phase.hpp"
#include "collision/engines/realign_by.hpp"
#include "collision/scene/narrow_phase.hpp"
#include "collision/tree/kdop_tree.hpp"

namespace peerd::collision::engines {

// A way to find collisions that `peerd collide --engine` can choose: ours, or one that the thesis's chapters 2 and 3
// compare.
struct EngineDescription {
  std::string_view name;
  bool is_exact = true;  // false: it may take what is near for a touch
  std::string_view reference;
  std::string_view about;
};
[[nodiscard]] std::span<const EngineDescription> engines();

struct Engine {
  EngineDescription description;
  std::unique_ptr<NarrowPhase> narrow_phase;  // null: ours
  BroadPhaseMethod broad_phase = BroadPhaseMethod::kInterestLists;
  bool has_space_time_bounds = false;  // from tick to tick, SpaceTimeBroadPhase stands in for broad_phase
};

// Makes an engine of "NAME" or "NAME,option=value..". `kdop` has the options k (6, 14, 18, 26), rule (a SplitRule's
// name), threshold (1 to 1000000), build (lazy, whole) and realign (RealignBy: slabs, boundary, hull); `sphere` has
// bounds (space-time, none) and depth (0 to 64: the last level of its trees); `cylinders` has axis (world, model); the
// others have none. The error says what is wrong.
[[nodiscard]] std::expected<Engine, std::string> make_engine(std::string_view words);

// The options of `kdop`, of words such as "k=18,rule=min-sum,threshold=4", in any order; those that are not named are
// at their defaults. `k` is 6, 14, 18 or 26. The error says what is wrong.
struct KdopOptions {
  std::uint32_t k = 18;
  TreeOptions tree;
  RealignBy realign = RealignBy::kSlabs;
  bool whole =
      false;  // build=whole: a tree is built to its leaves at once, as the thesis does; build=lazy: as queries go
};
[[nodiscard]] std::expected<KdopOptions, std::string> kdop_options(std::string_view words);

}  // namespace peerd::collision::engines
