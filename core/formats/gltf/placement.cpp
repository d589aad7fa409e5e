#include "core/formats/gltf/placement.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/atan2.hpp"

namespace peerd::formats::gltf {
namespace {

// All sums are written out: peers must get the same bits, whatever their instruction set.
Mat3 product(const Mat3& a, const Mat3& b) {
  Mat3 out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out(r, c) = a(r, 0) * b(0, c) + a(r, 1) * b(1, c) + a(r, 2) * b(2, c);
  }
  return out;
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}
double dot(const Vec3& a, const Vec3& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }
Vec3 unit(const Vec3& v) { return v / std::sqrt(dot(v, v)); }

// Jacobi's method: the eigenvectors of a symmetric matrix as the columns of a rotation; `s` becomes the diagonal matrix
// of eigenvalues. It converges quadratically; the sweeps are many more than binary64 needs.
Mat3 eigenvectors(Mat3& s) {
  constexpr int kSweeps = 16;
  Mat3 v = Mat3::Identity();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (s(p, q) == 0.0) continue;
      const double theta = (s(q, q) - s(p, p)) / (2.0 * s(p, q));
      const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0);
      Mat3 turn = Mat3::Identity();
      turn(p, p) = turn(q, q) = c;
      turn(p, q) = t * c;
      turn(q, p) = -t * c;
      s = product(product(turn.transpose(), s), turn);
      s(p, q) = s(q, p) = 0.0;
      v = product(v, turn);
    }
  }
  return v;
}

std::array<float, 3> floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// The axis and angle of a rotation matrix, by its quaternion (Shepperd 1978: the largest component first).
std::array<float, 4> axis_angle_of(const Mat3& r) {
  const double trace = r(0, 0) + r(1, 1) + r(2, 2);
  int k = 0;
  for (int i = 1; i < 3; ++i) k = r(i, i) > r(k, k) ? i : k;
  std::array<double, 4> q{};  // x, y, z, w, of any length
  if (trace > r(k, k)) {
    q = {r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1), 1.0 + trace};
  } else {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    q[static_cast<std::size_t>(k)] = 1.0 + r(k, k) - r(i, i) - r(j, j);
    q[static_cast<std::size_t>(i)] = r(i, k) + r(k, i);
    q[static_cast<std::size_t>(j)] = r(j, k) + r(k, j);
    q[3] = r(j, i) - r(i, j);
  }
  return axis_angle(q);
}

// Returns the rotation of a quaternion (x, y, z, w) of any length; the identity for length 0.
Mat3 matrix_of(std::span<const double, 4> q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3], square = x * x + y * y + z * z + w * w;
  if (!(square > 0.0)) return Mat3::Identity();
  const double s = 2.0 / square;
  Mat3 r;
  r << 1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),  //
      s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w),   //
      s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y);
  return r;
}

// Returns a unit vector at right angles to a unit vector.
Vec3 perpendicular(const Vec3& known) {
  Vec3 other = Vec3::Zero();
  other(std::abs(known.x()) < 0.6 ? 0 : 1) = 1.0;  // not along `known`: it has length 1
  return unit(cross(known, other));
}

// Returns orthogonal unit vectors in the directions of the images of orthogonal axes. The longest image keeps its
// direction. From the second, the share along the first is subtracted. The third is their cross product. Short images
// come last because they are mostly rounding.
Mat3 directions(const Mat3& images, const Vec3& lengths) {
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [&](int i, int j) { return lengths(i) > lengths(j); });
  const auto [first, second, third] = order;
  if (!(lengths(first) > 0.0)) return Mat3::Identity();
  Mat3 u;
  u.col(first) = images.col(first) / lengths(first);
  const Vec3 rest = images.col(second) - dot(images.col(second), u.col(first)) * u.col(first);
  // An image that is shorter than the rounding of a longer one has no direction of its own.
  u.col(second) =
      lengths(second) > 1e-12 * lengths(first) && dot(rest, rest) > 0.0 ? unit(rest) : perpendicular(u.col(first));
  const Vec3 last = cross(u.col(first), u.col(second));
  u.col(third) = dot(last, images.col(third)) < 0.0 ? Vec3(-last) : last;
  return u;
}

}  // namespace

Mat3 linear_below(const Mat3& above, const tinygltf::Node& node) {
  Mat3 linear = Mat3::Identity();
  if (node.matrix.size() == 16) {
    for (std::size_t i = 0; i < 9; ++i) {
      linear(static_cast<int>(i % 3), static_cast<int>(i / 3)) = node.matrix[i / 3 * 4 + i % 3];
    }
    return product(above, linear);
  }
  if (node.rotation.size() == 4) linear = matrix_of(std::span<const double, 4>(node.rotation.data(), 4));
  for (int c = 0; c < 3 && node.scale.size() == 3; ++c) {
    for (int r = 0; r < 3; ++r) linear(r, c) *= node.scale[static_cast<std::size_t>(c)];
  }
  return product(above, linear);
}

std::array<float, 4> axis_angle(std::span<const double, 4> q) {
  const double sign = q[3] < 0.0 ? -1.0 : 1.0;
  const Vec3 v(sign * q[0], sign * q[1], sign * q[2]);
  const double length = std::sqrt(dot(v, v));
  if (!(length > 0.0)) return {0, 0, 1, 0};
  const auto axis = floats(v / length);
  return {axis[0], axis[1], axis[2], static_cast<float>(2.0 * peerd::atan2(length, sign * q[3]))};
}

TransformValues transform_of(std::span<const double, 16> m) {
  Mat3 linear;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) linear(static_cast<int>(r), static_cast<int>(c)) = m[4 * c + r];
  }
  Mat3 squares = product(linear.transpose(), linear);
  const Mat3 axes = eigenvectors(squares);
  const Mat3 images = product(linear, axes);
  Vec3 scale;
  for (int i = 0; i < 3; ++i) scale(i) = std::sqrt(dot(images.col(i), images.col(i)));
  Mat3 u = directions(images, scale);
  if (dot(cross(u.col(0), u.col(1)), u.col(2)) < 0.0) {
    // One axis is mirrored: the one whose image points away from it the most, so that little is left to rotate.
    int k = 0;
    for (int i = 1; i < 3; ++i) k = dot(u.col(i), axes.col(i)) < dot(u.col(k), axes.col(k)) ? i : k;
    u.col(k) = -u.col(k);
    scale(k) = -scale(k);
  }
  TransformValues values;
  values.translation = floats({m[12], m[13], m[14]});
  values.scale = floats(scale);
  values.rotation = axis_angle_of(product(u, axes.transpose()));
  values.scale_orientation = axis_angle_of(axes);
  return values;
}

}  // namespace peerd::formats::gltf
