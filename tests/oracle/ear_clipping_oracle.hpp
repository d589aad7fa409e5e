#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace peerd::oracle {

// Cuts a polygon (x, y) of at least 3 corners into triangles of corner numbers by the rule that core/geometry/
// ear_clipping.hpp states, word for word and with rational numbers. The time is up to n^3.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> cut_ears(const std::vector<std::pair<double, double>>& polygon);

}  // namespace peerd::oracle
