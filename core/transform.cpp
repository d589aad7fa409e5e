#include "core/transform.hpp"

#include <cmath>

namespace peerd {

Vec3 multiply(const Mat3& m, const Vec3& v) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = (m(i, 0) * v[0] + m(i, 1) * v[1]) + m(i, 2) * v[2];
  return out;
}

Mat3 multiply(const Mat3& a, const Mat3& b) {
  Mat3 out;
  for (int j = 0; j < 3; ++j) out.col(j) = multiply(a, Vec3(b.col(j)));
  return out;
}

Quat multiply(const Quat& a, const Quat& b) {
  return {((a.w() * b.w() - a.x() * b.x()) - a.y() * b.y()) - a.z() * b.z(),
          ((a.w() * b.x() + a.x() * b.w()) + a.y() * b.z()) - a.z() * b.y(),
          ((a.w() * b.y() + a.y() * b.w()) + a.z() * b.x()) - a.x() * b.z(),
          ((a.w() * b.z() + a.z() * b.w()) + a.x() * b.y()) - a.y() * b.x()};
}

Quat normalized(const Quat& q) {
  const double length = std::sqrt(((q.w() * q.w() + q.x() * q.x()) + q.y() * q.y()) + q.z() * q.z());
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

Affine multiply(const Affine& a, const Affine& b) {
  return {multiply(a.linear, b.linear), multiply(a.linear, b.offset) + a.offset};
}

namespace {

// Returns SR * S * SR^-1.
Mat3 scale_of(const TransformFields& t) {
  const Mat3 sr = t.scale_orientation.toRotationMatrix();
  Mat3 scaled = sr;
  for (int j = 0; j < 3; ++j) scaled.col(j) *= t.scale[j];
  return multiply(scaled, Mat3(sr.transpose()));
}

}  // namespace

Affine parent_from_local(const TransformFields& t) {
  Affine out;
  out.linear = t.rotation.toRotationMatrix();
  if (is_scaled(t)) out.linear = multiply(out.linear, scale_of(t));
  out.offset = t.translation + (t.center - multiply(out.linear, t.center));
  return out;
}

Pose rigid_pose(std::span<const TransformFields> path) { return rigid_pose(Mat3::Identity(), path); }

Pose rigid_pose(const Mat3& stretch, std::span<const TransformFields> path) {
  Affine product{stretch, Vec3::Zero()};
  Quat rotation = Quat::Identity();
  for (const TransformFields& t : path) {
    product = multiply(product, parent_from_local(t));
    rotation = multiply(rotation, t.rotation);
  }
  return {product.offset, normalized(rotation)};
}

StretchedPose stretched_pose(std::span<const TransformFields> path) {
  StretchedPose out{rigid_pose(path)};
  bool stretched = false;
  for (const TransformFields& t : path) {
    if (stretched) {
      const Mat3 rotation = t.rotation.toRotationMatrix();
      out.stretch = multiply(Mat3(rotation.transpose()), multiply(out.stretch, rotation));
      if (is_scaled(t)) out.stretch = multiply(out.stretch, scale_of(t));
    } else if (is_scaled(t)) {
      out.stretch = scale_of(t);
      stretched = true;
    }
  }
  return out;
}

}  // namespace peerd
