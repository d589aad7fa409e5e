#pragma once
#include <cstdint>

#include <nlohmann/json_fwd.hpp>

namespace peerd::measure {

// Turns the runs of summary.json into points: each `repeat` successive runs differ in their seed alone and make one
// point, with every number of measures.hpp as {mean, half_width_95} (interval.hpp), in the shape of a run. See
// docs/reference/measures.md, "Repetition".
[[nodiscard]] nlohmann::ordered_json points_json(const nlohmann::ordered_json& runs, std::uint32_t repeat);

}  // namespace peerd::measure
