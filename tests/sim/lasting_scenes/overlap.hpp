#pragma once
#include "tests/sim/lasting_scenes/scene.hpp"

namespace peerd::sim::lasting_scenes {

// How deep two bodies are in each other [m]; negative: a lower bound of their distance. Exact for boxes (separating
// axes) and balls, by nothing of the project's collision library. Of a room and what is in it: how far that is out.
[[nodiscard]] double overlap_m(const Body& a, const Pose& at_a, const Body& b, const Pose& at_b);

}  // namespace peerd::sim::lasting_scenes
