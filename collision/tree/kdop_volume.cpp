#include "collision/tree/kdop_volume.hpp"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

namespace peerd::collision {
namespace {

struct CutScratch {
  std::vector<double> outside;  // by corner: how far it is on the wrong side, times the normal's length
  std::vector<Vec3> polygon;
};

// Keeps the part of a convex polygon where normal . p <= offset. Most planes cut nothing off.
void cut(std::vector<Vec3>& polygon, CutScratch& scratch, const Vec3& normal, double offset) {
  scratch.outside.clear();
  bool cuts = false;
  for (const Vec3& p : polygon) {
    scratch.outside.push_back(normal.dot(p) - offset);
    cuts = cuts || !(scratch.outside.back() <= 0.0);
  }
  if (!cuts) return;
  std::vector<Vec3>& out = scratch.polygon;
  out.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = i + 1 < polygon.size() ? i + 1 : 0;
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[next];
    const double p_out = scratch.outside[i], q_out = scratch.outside[next];
    if (p_out <= 0.0) out.push_back(p);
    if ((p_out < 0.0 && q_out > 0.0) || (p_out > 0.0 && q_out < 0.0)) {
      out.push_back(p + (q - p) * (p_out / (p_out - q_out)));
    }
  }
  polygon.swap(out);
}

// A square in the plane normal . p = offset that holds all of the box of half side `size` around `center`.
std::vector<Vec3> square(const Vec3& normal, double offset, const Vec3& center, double size) {
  const Vec3 n = normal.normalized();
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 foot = center + n * ((offset - normal.dot(center)) / normal.norm());
  return {foot + size * (u + v), foot + size * (v - u), foot - size * (u + v), foot + size * (u - v)};
}

}  // namespace

template <int K>
std::vector<std::vector<Vec3>> boundary(const WideKdop<K>& dop) {
  constexpr auto directions = kdop_directions<K>();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (!(dop.lo[i] <= dop.hi[i])) return {};
  }
  const auto normal = [&](std::size_t face) {
    const auto& d = directions[face / 2];
    return Vec3(Vec3(d[0], d[1], d[2]) * (face % 2 == 0 ? 1.0 : -1.0));
  };
  const auto offset = [&](std::size_t face) { return face % 2 == 0 ? dop.hi[face / 2] : -dop.lo[face / 2]; };
  const Vec3 low(dop.lo[0], dop.lo[1], dop.lo[2]), high(dop.hi[0], dop.hi[1], dop.hi[2]);
  const double size = 2.0 * (high - low).norm();
  std::vector<std::vector<Vec3>> faces;
  CutScratch scratch;
  for (std::size_t face = 0; face < K; ++face) {
    std::vector<Vec3> polygon = square(normal(face), offset(face), (low + high) / 2, size);
    for (std::size_t other = 0; other < K && !polygon.empty(); ++other) {
      if (other / 2 != face / 2) cut(polygon, scratch, normal(other), offset(other));
    }
    if (polygon.size() >= 3) faces.push_back(std::move(polygon));
  }
  return faces;
}

// The divergence theorem is applied from a point inside, so that far-away boxes lose nothing to rounding.
template <int K>
double volume(const WideKdop<K>& dop) {
  const Vec3 center(dop.lo[0] / 2 + dop.hi[0] / 2, dop.lo[1] / 2 + dop.hi[1] / 2, dop.lo[2] / 2 + dop.hi[2] / 2);
  if constexpr (K == 6) {
    double product = 1.0;
    for (std::size_t i = 0; i < 3; ++i) product *= std::max(0.0, dop.hi[i] - dop.lo[i]);
    return product;
  }
  double six_volumes = 0.0;
  for (const std::vector<Vec3>& face : boundary(dop)) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      six_volumes += std::abs((face[0] - center).dot((face[i] - center).cross(face[i + 1] - center)));
    }
  }
  assert(!(six_volumes < 0.0));
  return six_volumes / 6.0;
}

template std::vector<std::vector<Vec3>> boundary(const WideKdop<6>&);
template std::vector<std::vector<Vec3>> boundary(const WideKdop<14>&);
template std::vector<std::vector<Vec3>> boundary(const WideKdop<18>&);
template std::vector<std::vector<Vec3>> boundary(const WideKdop<26>&);
template double volume(const WideKdop<6>&);
template double volume(const WideKdop<14>&);
template double volume(const WideKdop<18>&);
template double volume(const WideKdop<26>&);

}  // namespace peerd::collision
