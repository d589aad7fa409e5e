#pragma once
#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

// The same question as touch(), asked in another way: is there a point that is a mean of both triangles' points? Exact,
// several times slower. Each answer is proved before it is returned, by a common point or by a plane that separates the
// triangles; an answer that cannot be proved throws std::logic_error.
[[nodiscard]] bool touch_by_simplex(const Triangle& a, const Triangle& b);

}  // namespace peerd::oracle
