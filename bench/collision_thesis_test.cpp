#include "collision_thesis_test.hpp"

#include <Eigen/Geometry>
#include <span>

namespace peerd::bench {
namespace {

// A point p is inside where a ray from it along i crosses an odd number of edges, in the plane of the coordinates i
// and j.
bool inside(std::span<const Vec3> polygon, const Vec3& p, int i, int j) {
  bool odd = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 u = polygon[k] - p, v = polygon[(k + 1) % polygon.size()] - p;
    if ((u[j] >= 0) == (v[j] >= 0)) continue;
    if (u[i] >= 0 && v[i] >= 0) {
      odd = !odd;
    } else if (u[i] >= 0 || v[i] >= 0) {
      odd ^= u[i] - u[j] * (v[i] - u[i]) / (v[j] - u[j]) >= 0;
    }
  }
  return odd;
}

bool an_edge_crosses(std::span<const Vec3> edges, std::span<const Vec3> polygon) {
  const Vec3 n = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[0]);
  int most = 0;
  n.cwiseAbs().maxCoeff(&most);
  const int i = (most + 1) % 3, j = (most + 2) % 3;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Vec3 &u = edges[k], &v = edges[(k + 1) % edges.size()];
    const double above_u = n.dot(u - polygon[0]), above_v = n.dot(v - polygon[0]);
    if ((above_u > 0) == (above_v > 0)) continue;
    if (inside(polygon, u + (v - u) * (above_u / (above_u - above_v)), i, j)) return true;
  }
  return false;
}

}  // namespace

bool thesis_polygons_touch(const collision::Triangle& a, const collision::Triangle& b) {
  return an_edge_crosses(a, b) || an_edge_crosses(b, a);
}

}  // namespace peerd::bench
