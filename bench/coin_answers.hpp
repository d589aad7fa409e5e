#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/box.hpp"
#include "core/math.hpp"

namespace peerd::bench {

// These functions return what Coin makes of a world, by its own classes and in its own binary32. The caller calls
// start_coin() first. They return nothing where Coin reports an error.

using Triangle = std::array<Vec3, 3>;

// The triangles of each Shape in the world frame, in the order of the file; a USEd one counts again.
[[nodiscard]] std::optional<std::vector<std::vector<Triangle>>> shapes_of_coin(std::string_view text);

[[nodiscard]] std::optional<WorldBox> box_of_coin(std::string_view text);

// value_changed of the world's first interpolator after set_fraction, for each fraction: flat; an SFRotation is a
// quaternion x y z w.
[[nodiscard]] std::optional<std::vector<std::vector<double>>> values_of_coin(std::string_view text,
                                                                             std::span<const float> fractions);

}  // namespace peerd::bench
