#pragma once
#include <cmath>

namespace peerd::bench::peers {

// Peers know nothing of Eigen's types, or of another alignment of them, so what crosses between us is plain. Sums are
// from left to right: scenes are the same, number for number, as those of the measurements that went before.
struct Point {
  double x, y, z;
};
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point unit(const Point& a) { return (1 / length(a)) * a; }

// Takes p of a body to rotation * p + position.
struct Placement {
  double rotation[3][3];
  Point position;
};
inline Point operator*(const Placement& m, const Point& p) {
  const auto& r = m.rotation;
  return {r[0][0] * p.x + r[0][1] * p.y + r[0][2] * p.z + m.position.x,
          r[1][0] * p.x + r[1][1] * p.y + r[1][2] * p.z + m.position.y,
          r[2][0] * p.x + r[2][1] * p.y + r[2][2] * p.z + m.position.z};
}

}  // namespace peerd::bench::peers
