#pragma once
#include <cstdint>

#include <nlohmann/json.hpp>

namespace peerd::report {

// Of the runs of summary.json, `repeat` after each other that differ in their seed alone, one point: every number that
// measures.hpp names as {mean, half_width_95} (interval.hpp), in the shape that a run has. README: "Repetition".
[[nodiscard]] nlohmann::ordered_json points_json(const nlohmann::ordered_json& runs, std::uint32_t repeat);

}  // namespace peerd::report
