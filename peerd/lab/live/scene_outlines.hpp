#pragma once
#include <cstddef>
#include <vector>

#include "core/scene/scene.hpp"
#include "peerd/lab/measure/run_record.hpp"

namespace peerd {

// Outlines for the pictures, from above, of the Shapes with a surface that collide or are drawn: the convex hull of
// each. A Shape of an owned object is placed where the truth has the object at first, any other one where the file has
// it; what the world itself moves and nobody owns is left out.
struct SceneOutlines {
  std::vector<measure::SceneOutline> outlines;
  std::size_t left_out = 0;  // Shapes beyond the limits
};

// Shapes beyond kOutlinesMax are left out; those are taken that are nearest to the places of the run's objects, the
// larger ones first where they are equally near. The world axes x and z count alone. The rows of the record are
// complete.
inline constexpr std::size_t kOutlinesMax = 400;
[[nodiscard]] SceneOutlines outlines_of(const Scene& scene, const measure::RunRecord& run);

}  // namespace peerd
