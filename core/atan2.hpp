#pragma once

namespace peerd {

// Returns the angle from the x axis to (x, y) [rad], in [-pi, pi], by operations that IEEE 754 defines to the last bit
// (see sin_cos.hpp for why). The error is below 6e-16, and below 5e-16 of the angle itself. Signed zeros are treated as
// in C; (0, 0) gives 0 or pi. An argument that is not finite gives NaN.
[[nodiscard]] double atan2(double y, double x);

}  // namespace peerd
