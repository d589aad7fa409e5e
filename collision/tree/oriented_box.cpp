#include "collision/tree/oriented_box.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::collision {
namespace {

float largest(Float4 p) { return std::max(std::max(p[0], p[1]), p[2]); }

// One rotation, after which the matrix has nothing at (p, q); none where what is there is small.
void rotate_away(Mat3& m, Mat3& axes, int p, int q, double small) {
  const double off = m(p, q);
  if (!(std::abs(off) > small)) return;
  const double d = 0.5 * (m(q, q) - m(p, p));
  const double t = off / (d + std::copysign(std::sqrt(d * d + off * off), d));
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  const int r = 3 - p - q;
  m(p, p) -= t * off;
  m(q, q) += t * off;
  m(p, q) = m(q, p) = 0.0;
  const double rp = m(r, p), rq = m(r, q);
  m(r, p) = m(p, r) = c * rp - s * rq;
  m(r, q) = m(q, r) = s * rp + c * rq;
  for (int k = 0; k < 3; ++k) {
    const double kp = axes(k, p), kq = axes(k, q);
    axes(k, p) = c * kp - s * kq;
    axes(k, q) = s * kp + c * kq;
  }
}

}  // namespace

OrientedBox axis_aligned_box(const Bounds4& bounds) {
  OrientedBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const float lo = -bounds.minus_lo[k], hi = bounds.hi[k];
    box.center[k] = 0.5f * lo + 0.5f * hi;
    box.half[k] = std::max(hi - box.center[k], box.center[k] - lo);
  }
  return box;
}

// Four sweeps make a box's axes right to far more than it is worth; most matrices need two. Axes that are off by 2^-10
// or so make a box that is no worse.
Mat3 principal_axes(const Mat3& matrix) {
  Mat3 m = matrix, axes = Mat3::Identity();
  const double small = 0x1p-12 * (std::abs(m(0, 0)) + std::abs(m(1, 1)) + std::abs(m(2, 2)));
  for (int sweep = 0; sweep < 4; ++sweep) {
    if (!(std::max({std::abs(m(0, 1)), std::abs(m(0, 2)), std::abs(m(1, 2))}) > small)) break;
    rotate_away(m, axes, 0, 1, small);
    rotate_away(m, axes, 0, 2, small);
    rotate_away(m, axes, 1, 2, small);
  }
  return axes;
}

BoxFit::BoxFit(const Bounds4& bounds) : bounds_(bounds) {
  const Float4 half = all4(0.5f) * bounds.minus_lo + all4(0.5f) * bounds.hi;
  middle_ = all4(0.5f) * bounds.hi - all4(0.5f) * bounds.minus_lo;
  const float unit = 1.0f / largest(half);
  to_unit_ = all4(std::isfinite(unit) ? unit : 0.0f);
}

bool BoxFit::turn() {
  if (!(area_ > 0.0f)) return false;
  const double per_third = 1.0 / (3.0 * static_cast<double>(area_)), per_twelfth = 0.25 * per_third;
  Vec3 mean;
  Mat3 second;
  for (int i = 0; i < 3; ++i) {
    mean[i] = static_cast<double>(first_[i]) * per_third;
    for (int j = 0; j < 3; ++j) second(i, j) = static_cast<double>(second_[i][j]) * per_twelfth;
  }
  Mat3 covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) covariance(i, j) = covariance(j, i) = second(i, j) - mean[i] * mean[j];
  }
  const Mat3 found = principal_axes(covariance);
  std::array<std::array<float, 3>, 3> axes;
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t k = 0; k < 3; ++k) {
      axes[j][k] = static_cast<float>(found(static_cast<int>(k), static_cast<int>(j)));
      if (!std::isfinite(axes[j][k])) return false;
    }
  }
  turn_to(axes);
  return true;
}

void BoxFit::turn_to(const std::array<std::array<float, 3>, 3>& axes) {
  for (std::size_t k = 0; k < 3; ++k) columns_[k] = Float4{axes[0][k], axes[1][k], axes[2][k], 0.0f};
  turned_ = true;
}

void BoxFit::add(const OrientedBox& other) {
  const auto along = [&](const std::array<float, 3>& p) {
    return (all4(p[0]) * columns_[0] + all4(p[1]) * columns_[1]) + all4(p[2]) * columns_[2];
  };
  const Float4 l = Float4{other.center[0], other.center[1], other.center[2], 0.0f} - middle_;
  const Float4 at = along({l[0], l[1], l[2]});
  Float4 reach{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Float4 d = along(other.axes[k]);
    reach += all4(other.half[k]) * max4(d, -d);
  }
  // The rounding of the other box's center, which is not in its extents.
  const float off = 0x1p-20f * (((other.half[0] + other.half[1]) + other.half[2]) +
                                ((std::abs(other.center[0]) + std::abs(other.center[1])) + std::abs(other.center[2])));
  reach += all4(off);
  extent_.merge({reach - at, reach + at});
}

// Along an axis the rounding of what was added is a dozen times 2^-24 of the sizes that are summed up here, and half of
// it is what the axes' rounding to binary32 makes.
OrientedBox BoxFit::box() const {
  const OrientedBox aligned = axis_aligned_box(bounds_);
  if (!turned_) return aligned;
  OrientedBox turned;
  const float pad = 0x1p-20f * ((aligned.half[0] + aligned.half[1]) + aligned.half[2]);
  const Float4 half = all4(0.5f) * extent_.minus_lo + all4(0.5f) * extent_.hi + all4(pad);
  const Float4 at = all4(0.5f) * extent_.hi - all4(0.5f) * extent_.minus_lo;
  for (std::size_t k = 0; k < 3; ++k) {
    turned.half[k] = half[k];
    const Float4 column = columns_[k] * at;
    turned.center[k] = middle_[k] + ((column[0] + column[1]) + column[2]);
    for (std::size_t j = 0; j < 3; ++j) turned.axes[j][k] = columns_[k][j];
  }
  return turned.half_area() < aligned.half_area() ? turned : aligned;
}

}  // namespace peerd::collision
