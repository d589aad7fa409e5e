#include "core/scene/rotation.hpp"

#include <cmath>

#include "core/sin_cos.hpp"

namespace peerd::vrml {

Quat to_quat(std::span<const float, 4> rotation) {
  const double x = rotation[0];
  const double y = rotation[1];
  const double z = rotation[2];
  const double length = std::sqrt((x * x + y * y) + z * z);
  if (length == 0.0 || rotation[3] == 0.0f) return Quat::Identity();
  const auto [s, c] = sin_cos(0.5 * rotation[3]);
  return {c, s * (x / length), s * (y / length), s * (z / length)};
}

}  // namespace peerd::vrml
