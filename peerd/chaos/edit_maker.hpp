#pragma once
#include <cstdint>
#include <vector>

#include "peerd/chaos/plan.hpp"
#include "peerd/config/scene_edit.hpp"

namespace peerd {
struct Scene;
}

namespace peerd::chaos {

// The edits that a planned one means in a scene as it is: a function of the two.
[[nodiscard]] std::vector<config::SceneEdit> make_edits(const PlannedEdit& planned, const Scene& scene);

}  // namespace peerd::chaos
