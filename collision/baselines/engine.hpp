#pragma once
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "collision/broad_phase/broad_phase.hpp"
#include "collision/scene/narrow_phase.hpp"

namespace peerd::collision::baselines {

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
};

// Makes an engine of "NAME" or "NAME,option=value..". `kdop` has the options k (6, 14, 18, 26), rule (a SplitRule's
// name), threshold (1 to 1000000) and realign (RealignBy: slabs, boundary or hull); the others have none. The error
// says what is wrong.
[[nodiscard]] std::expected<Engine, std::string> make_engine(std::string_view words);

}  // namespace peerd::collision::baselines
