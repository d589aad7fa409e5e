#pragma once
#include <Eigen/Geometry>
#include <optional>

#include "core/math.hpp"

namespace peerd::view {

// An affine map as nodes of glTF may have it, which know no shear: p -> translation + rotation * (scale . (inner * p)).
struct NodePlace {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();
  std::optional<Quat> inner;  // of a node below; none: none is needed

  [[nodiscard]] Eigen::Affine3d map() const;
};

// The place is the map, which is finite, but for rounding.
[[nodiscard]] NodePlace place_of(const Eigen::Affine3d& map);

}  // namespace peerd::view
