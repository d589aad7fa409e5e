#include "core/geometry/extrusion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/geometry/exact_sum.hpp"
#include "core/geometry/polygon_writer.hpp"
#include "core/math.hpp"
#include "core/sin_cos.hpp"

// Whatever the standard leaves open is decided here, and by comparing numbers as they were written or by exact signs:
// - Points are one if their coordinates are equal. So it is decided whether the spine or the cross-section is closed.
// - Consecutive spine points that are one share their cross-section plane (6.18.3); those of the others are computed as
//   if it had been written once. If all are one the cross-section stays in y = 0.
// - Collinear means that the exact cross product is 0, or so small that rounding the file's decimals to binary32 can
// have
//   made it: 0.1 0.2 0.3 and 0.2 0.4 0.6 are on one line with 0 as they are written, and not as they are stored. The z
//   axes of such points would come from that noise, and the cross-sections twist.
// - A straight spine's direction is that of its first segment that has a length. One that points down turns the
//   cross-section half around z; any axis in y = 0 would be as short a way.
// - Where the spine comes straight back to where it was, spine[i+1] - spine[i-1] is 0. Then the y axis is the previous
//   point's, as the standard has it for the z axis. In a closed spine's first point it is spine[1] - spine[0].
// - The z axis is flipped if its product with the previous one is < 0 in binary64, before they are made units.
// - A closed spine's last ring is its first one if it has the same scale and orientation.
// - Caps of fewer than three corners are left out: they would only repeat the sides' edges.
// - Scales or orientations that are too few go on with the last; without any it's 1 1 and no rotation.
namespace peerd {
namespace {

using Point = Eigen::Vector3f;

// The spine-aligned cross-section plane: its axes, units.
struct Scp {
  Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
};

Vec3 minus(const Point& a, const Point& b) { return a.cast<double>() - b.cast<double>(); }

double dot(const Vec3& a, const Vec3& b) { return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z(); }

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

// The vector is neither too large nor too small to be squared: binary32 numbers and their products are within 2^+-298.
Vec3 unit(const Vec3& v) {
  const double length = std::sqrt(dot(v, v));
  return {v.x() / length, v.y() / length, v.z() / length};
}

double largest(const Vec3& v) { return std::max({std::abs(v.x()), std::abs(v.y()), std::abs(v.z())}); }

// (b - a) x (c - a). Computed exactly and rounded: 0 only if the points are collinear.
Vec3 exact_normal(const Point& a, const Point& b, const Point& c) {
  Vec3 n;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Index x = (k + 1) % 3, y = (k + 2) % 3;
    ExactSum sum;
    sum.add(a[x], b[y]), sum.subtract(a[y], b[x]);
    sum.add(b[x], c[y]), sum.subtract(b[y], c[x]);
    sum.add(c[x], a[y]), sum.subtract(c[y], a[x]);
    n[k] = sum.value();
  }
  return n;
}

// Returns exact_normal(), or 0 where that is no larger than the effect of rounding: each coordinate x is off by at most
// 2^-24 |x|, and moves a component by that times the extents of the two sides.
Vec3 normal(const Point& a, const Point& b, const Point& c) {
  const Vec3 n = exact_normal(a, b, c);
  const double size = (largest(a.cast<double>()) + largest(b.cast<double>())) + largest(c.cast<double>());
  const double sides = (largest(minus(b, a)) + largest(minus(c, b))) + largest(minus(a, c));
  return largest(n) <= 0x1p-24 * size * sides ? Vec3::Zero() : n;
}

bool is_straight(const std::vector<Point>& path) {
  return std::ranges::all_of(path, [&](const Point& p) { return normal(path.front(), path[1], p) == Vec3::Zero(); });
}

// The shortest rotation that takes +y to d:  c I + [v]x + v v^T / (1 + c), v = y x d, c = y . d; its columns.
Scp straight_scp(const Vec3& d) {
  const double c = d.y(), sine2 = d.x() * d.x() + d.z() * d.z();  // 0 only if x and z are
  if (sine2 == 0.0) return c > 0.0 ? Scp{} : Scp{-Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitZ()};
  const double k = c > 0.0 ? 1.0 / (1.0 + c) : (1.0 - c) / sine2;  // equal; the former would cancel
  const double xz = -(k * (d.x() * d.z()));
  return {{c + k * (d.z() * d.z()), -d.x(), xz}, d, {xz, -d.z(), c + k * (d.x() * d.x())}};
}

// path: consecutive points differ, and not all are collinear. Where it bends so gently that no three points in a row
// show it, `normal_of` must be the exact one.
std::optional<std::vector<Scp>> bent_scps(const std::vector<Point>& path,
                                          Vec3 (*normal_of)(const Point&, const Point&, const Point&)) {
  const std::size_t count = path.size(), last = count - 1;
  const bool closed = path.front() == path.back();
  std::vector<Vec3> y(count), z(count);
  std::optional<std::size_t> first_defined;
  for (std::size_t i = 0; i < count; ++i) {
    // The first and the last point of an open spine stand for their own neighbour: y is along the one segment, and z
    // undefined.
    const Point& previous = i > 0 ? path[i - 1] : closed ? path[last - 1] : path[0];
    const Point& next = i < last ? path[i + 1] : closed ? path[1] : path[last];
    y[i] = minus(next, previous);
    if (y[i] == Vec3::Zero()) y[i] = i > 0 ? y[i - 1] : minus(path[1], path[0]);
    z[i] = normal_of(path[i], next, previous);
    const bool defined = z[i] != Vec3::Zero();
    if (defined && !first_defined) {
      std::fill_n(z.begin(), i, z[i]);
      first_defined = i;
    }
    if (i > 0 && !defined) z[i] = z[i - 1];
    if (i > 0 && dot(z[i], z[i - 1]) < 0.0) z[i] = -z[i];
  }
  if (!first_defined) return std::nullopt;
  std::vector<Scp> scps(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 unit_y = unit(y[i]), unit_z = unit(z[i]);
    scps[i] = {cross(unit_y, unit_z), unit_y, unit_z};
  }
  if (closed) scps[last] = scps[0];
  return scps;
}

// Returns the cross-section plane of each spine point.
std::vector<Scp> spine_scps(std::span<const Point> spine) {
  std::vector<Point> path;  // without consecutive points that are one
  std::vector<std::size_t> place;
  for (const Point& p : spine) {
    if (path.empty() || p != path.back()) path.push_back(p);
    place.push_back(path.size() - 1);
  }
  if (path.size() == 1) return std::vector<Scp>(spine.size());
  if (is_straight(path)) return std::vector<Scp>(spine.size(), straight_scp(unit(minus(path[1], path[0]))));
  auto bent = bent_scps(path, normal);
  if (!bent) bent = bent_scps(path, exact_normal);
  const std::vector<Scp>& scps = bent.value();
  std::vector<Scp> result;
  for (const std::size_t i : place) result.push_back(scps[i]);
  return result;
}

class Rotation {
 public:
  explicit Rotation(const std::array<float, 4>& axis_angle) {
    const Vec3 axis(axis_angle[0], axis_angle[1], axis_angle[2]);
    if (axis == Vec3::Zero() || axis_angle[3] == 0.0F) return;  // none
    axis_ = unit(axis);
    angle_ = sin_cos(axis_angle[3]);
  }
  // Rodrigues: v cos + (a x v) sin + a (a.v) (1 - cos)
  [[nodiscard]] Vec3 operator*(const Vec3& v) const {
    const Vec3 side = cross(axis_, v);
    const double along = dot(axis_, v) * (1.0 - angle_.cos);
    Vec3 out;
    for (int k = 0; k < 3; ++k) out[k] = (v[k] * angle_.cos + side[k] * angle_.sin) + axis_[k] * along;
    return out;
  }

 private:
  Vec3 axis_ = Vec3::Zero();
  SinCos angle_;
};

template <class T>
T value_at(const SharedArray<T>& values, std::size_t i, const T& otherwise) {
  return values.empty() ? otherwise : values[std::min(i, values.size() - 1)];
}

// The vertices of an extrusion: rings of the points of the cross-section, one ring for each spine point.
struct Layout {
  explicit Layout(const ExtrusionGeometry& e) : spine_points(e.spine.size()), section_points(e.cross_section.size()) {
    if (spine_points < 2 || section_points < 2) return;
    const std::size_t last = spine_points - 1;
    rings =
        spine_points -
        (e.spine[0] == e.spine[last] && scale(e, 0) == scale(e, last) && orientation(e, 0) == orientation(e, last) ? 1
                                                                                                                   : 0);
    ring = section_points - (e.cross_section[0] == e.cross_section[section_points - 1] ? 1 : 0);
    const std::uint64_t caps = ring < 3 ? 0 : std::uint64_t{e.begin_cap} + std::uint64_t{e.end_cap};
    const std::uint64_t quadrilaterals = std::uint64_t{last} * (section_points - 1);
    size = {quadrilaterals + caps, 2 * quadrilaterals + (caps > 0 ? caps * (ring - 2) : 0)};
  }

  static std::array<float, 2> scale(const ExtrusionGeometry& e, std::size_t i) { return value_at(e.scale, i, {1, 1}); }
  static std::array<float, 4> orientation(const ExtrusionGeometry& e, std::size_t i) {
    return value_at(e.orientation, i, {0, 0, 1, 0});
  }
  // The ring around to itself where it's closed, and so are the rings.
  [[nodiscard]] std::uint64_t vertex(std::size_t i, std::size_t j) const {
    return std::uint64_t{i % rings} * ring + j % ring;
  }

  std::size_t spine_points, section_points;
  std::size_t rings = 0, ring = 0;
  MeshSize size;
};

}  // namespace

MeshSize extrusion_size(const ExtrusionGeometry& extrusion) { return Layout(extrusion).size; }

Mesh build_extrusion(const ExtrusionGeometry& e) {
  const Layout layout(e);
  if (layout.size.polygons == 0) return {};
  const std::size_t last = layout.spine_points - 1;
  PolygonWriter out(std::uint64_t{layout.rings} * layout.ring, layout.size);

  const std::vector<Scp> scps = spine_scps(e.spine.span());
  for (std::size_t i = 0; i < layout.rings; ++i) {
    const std::array<float, 2> scale = Layout::scale(e, i);
    const Rotation rotation(Layout::orientation(e, i));
    const Scp& scp = scps[i];
    const Vec3 origin = e.spine[i].cast<double>();
    for (std::size_t j = 0; j < layout.ring; ++j) {
      const auto [x, z] = e.cross_section[j];
      const Vec3 q = rotation * Vec3(static_cast<double>(x) * static_cast<double>(scale[0]), 0.0,
                                     static_cast<double>(z) * static_cast<double>(scale[1]));
      const auto place = [&](int k) { return origin[k] + ((scp.x[k] * q.x() + scp.y[k] * q.y()) + scp.z[k] * q.z()); };
      out.vertex(place(0), place(1), place(2));
    }
  }
  for (std::size_t i = 0; i < last; ++i) {
    for (std::size_t j = 0; j + 1 < layout.section_points; ++j) {
      out.polygon({layout.vertex(i, j), layout.vertex(i, j + 1), layout.vertex(i + 1, j + 1), layout.vertex(i + 1, j)});
    }
  }
  if (layout.ring >= 3) {
    if (e.begin_cap) out.ring(layout.vertex(0, 0), layout.ring, /*reversed=*/true);
    if (e.end_cap) out.ring(layout.vertex(last, 0), layout.ring, /*reversed=*/false);
  }
  return std::move(out).finish(e.ccw);
}

}  // namespace peerd
