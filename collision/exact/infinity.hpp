#pragma once
#include <limits>

namespace peerd::collision {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace peerd::collision
