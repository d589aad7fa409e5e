#pragma once
#include <optional>

#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

// The least t >= 0 for which origin + t * direction is in the closed convex hull of three points, in rational numbers,
// rounded to the nearest binary64 number, ties to even; none where there is no such t. The direction is not zero.
[[nodiscard]] std::optional<double> first_parameter(const Point& origin, const Point& direction,
                                                    const Triangle& triangle);

}  // namespace peerd::oracle
