#include "peerd/view/picks/node_place.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::view {
namespace {

// A shear below that, relative to the scale, is rounding.
constexpr double kShear = 1e-9;

// Columns that are at right angles are a rotation times a scale. Where they are not, or one has no length, this is
// none.
std::optional<NodePlace> unsheared(const Mat3& m) {
  const Vec3 scale(m.col(0).norm(), m.col(1).norm(), m.col(2).norm());
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  Mat3 turned = m * scale.cwiseInverse().asDiagonal();
  const double shear = std::max({std::abs(turned.col(0).dot(turned.col(1))), std::abs(turned.col(1).dot(turned.col(2))),
                                 std::abs(turned.col(2).dot(turned.col(0)))});
  if (!(shear <= kShear)) return std::nullopt;
  NodePlace place;
  place.scale = scale;
  if (turned.determinant() < 0.0) {
    turned.col(0) = -turned.col(0);
    place.scale.x() = -place.scale.x();
  }
  if (!turned.isIdentity(1e-12)) place.rotation = Quat(turned).normalized();
  return place;
}

}  // namespace

Eigen::Affine3d NodePlace::map() const {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  out.linear() = rotation.toRotationMatrix() * scale.asDiagonal() * inner.value_or(Quat::Identity()).toRotationMatrix();
  out.translation() = translation;
  return out;
}

NodePlace place_of(const Eigen::Affine3d& map) {
  assert(map.matrix().allFinite());
  NodePlace place;
  const Mat3 linear = map.linear();
  if (linear != Mat3::Identity()) {
    if (const auto plain = unsheared(linear)) {
      place = *plain;
    } else {
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
      Mat3 u = svd.matrixU(), v = svd.matrixV();
      place.scale = svd.singularValues();
      for (Mat3* const each : {&u, &v}) {  // a reflection goes into the scale
        if (each->determinant() >= 0.0) continue;
        each->col(2) = -each->col(2);
        place.scale.z() = -place.scale.z();
      }
      place.rotation = Quat(u).normalized();
      place.inner = Quat(Mat3(v.transpose())).normalized();
    }
  }
  place.translation = map.translation();
  return place;
}

}  // namespace peerd::view
