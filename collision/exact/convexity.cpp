#include "collision/exact/convexity.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace peerd::collision {
namespace {

// A finite binary32 is an integer times a power of two, so all coordinates of a mesh times one common power of two are
// integers, and every sign below is decided by integer arithmetic without a division.
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using Integer3 = std::array<Integer, 3>;

Integer3 minus(const Integer3& a, const Integer3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integer3 cross(const Integer3& a, const Integer3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Integer exact_dot(const Integer3& a, const Integer3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
bool is_zero(const Integer3& a) { return a[0].is_zero() && a[1].is_zero() && a[2].is_zero(); }

// The unit vector of an integer one. The largest component is scaled to +-1 before squaring: the integers may exceed
// the square root of DBL_MAX. Relative error of each component: conversion 2u, division u, normalisation 4u; u = 2^-53.
Vec3 direction(const Integer3& a) {
  assert(!is_zero(a));
  const Vec3 v(a[0].convert_to<double>(), a[1].convert_to<double>(), a[2].convert_to<double>());
  const Vec3 scaled = v / v.cwiseAbs().maxCoeff();
  return scaled / std::sqrt(scaled.x() * scaled.x() + scaled.y() * scaled.y() + scaled.z() * scaled.z());
}

// A direction twice: unit in binary64 for the filters, exact (not unit) for the decisions.
struct Direction {
  Vec3 approximate;
  Integer3 exact;
};
Direction make_direction(Integer3 exact) {
  const Vec3 approximate = direction(exact);
  return {approximate, std::move(exact)};
}

// |a x b| of two units that carry < 8u each is off by < 20u; above 2^-48 = 32u it can't be zero.
bool parallel(const Direction& a, const Direction& b) {
  if (a.approximate.cross(b.approximate).norm() > 0x1p-48) return false;
  return is_zero(cross(a.exact, b.exact));
}

std::vector<Integer3> to_integers(const std::vector<Eigen::Vector3f>& vertices) {
  int least = 0;
  for (const Eigen::Vector3f& v : vertices) {
    for (const float x : v) {
      if (x != 0.0F) least = std::min(least, std::ilogb(x) - 23);
    }
  }
  std::vector<Integer3> result;
  result.reserve(vertices.size());
  for (const Eigen::Vector3f& v : vertices) {
    Integer3 p;
    for (std::size_t k = 0; k < 3; ++k) {
      const float x = v[static_cast<Eigen::Index>(k)];
      if (x == 0.0F) continue;
      const int exponent = std::ilogb(x) - 23;
      p[k] = Integer(static_cast<std::int64_t>(std::ldexp(static_cast<double>(x), -exponent))) << (exponent - least);
    }
    result.push_back(std::move(p));
  }
  return result;
}

class ConvexityTest {
 public:
  explicit ConvexityTest(const Mesh& mesh) : mesh_(mesh) {}

  std::expected<ConvexSurface, std::string> run() {
    std::optional<std::string> refused = gather();
    for (std::size_t i = 0; !refused && i < surface_.polygons.size(); ++i) refused = examine_polygon(i);
    if (!refused && !surface_.flat()) {
      refused = examine_edges();
      if (!refused) refused = examine_sides();
      if (!refused) refused = examine_orientation();
    } else if (!refused && !mesh_.ccw) {
      turn_over(0);
    }
    if (refused) return std::unexpected(*std::move(refused));
    assert(normals_.size() == surface_.polygons.size());
    for (const Direction& n : normals_) surface_.normals.push_back(n.approximate);
    choose_axes();
    assert(!surface_.face_axes.empty() && surface_.edge_axes.size() >= (surface_.flat() ? 2U : 3U));
    return std::move(surface_);
  }

 private:
  using Refusal = std::optional<std::string>;
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  // Models repeat a vertex for each polygon: positions are welded, and only exactly equal ones.
  Refusal gather() {
    const std::size_t polygons = mesh_.polygon_count();
    if (polygons > kMaxPiecePolygons) {
      return "more than " + std::to_string(kMaxPiecePolygons) + " polygons in one piece";
    }
    std::map<std::array<float, 3>, std::uint32_t> welded;
    for (std::size_t i = 0; i < polygons; ++i) {
      std::vector<std::uint32_t>& corners = surface_.polygons.emplace_back();
      for (const std::int32_t corner : mesh_.polygon(i)) {
        assert(corner >= 0 && static_cast<std::size_t>(corner) < mesh_.vertices.size());
        const Eigen::Vector3f& v = mesh_.vertices[static_cast<std::size_t>(corner)];
        if (!v.allFinite()) return "a vertex is not finite";
        const auto next = static_cast<std::uint32_t>(surface_.vertices.size());
        const auto [at, is_new] = welded.try_emplace({v.x(), v.y(), v.z()}, next);  // -0 == 0
        if (is_new) surface_.vertices.push_back(v);
        corners.push_back(at->second);
      }
      if (surface_.vertices.size() > kMaxPieceVertices) {
        return "more than " + std::to_string(kMaxPieceVertices) + " vertices in one piece";
      }
    }
    exact_ = to_integers(surface_.vertices);
    assert(exact_.size() == surface_.vertices.size() && surface_.polygons.size() == polygons);
    return std::nullopt;
  }

  // Requires a polygon to be planar and convex, with an area. A concave face of a convex polyhedron is refused too:
  // with convex faces alone, edges that match and sides that agree prove that the surface is the boundary of its convex
  // hull.
  Refusal examine_polygon(std::size_t i) {
    const std::vector<std::uint32_t>& c = surface_.polygons[i];
    const std::string name = "polygon " + std::to_string(i);
    std::vector<std::uint32_t> sorted = c;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end()) return name + " repeats a corner";
    Integer3 n;  // twice the area vector (Newell)
    for (std::size_t j = 1; j + 1 < c.size(); ++j) {
      const Integer3 part = cross(minus(exact_[c[j]], exact_[c[0]]), minus(exact_[c[j + 1]], exact_[c[0]]));
      for (std::size_t k = 0; k < 3; ++k) n[k] += part[k];
    }
    if (is_zero(n)) return name + " has no area";
    for (const std::uint32_t v : c) {
      if (!exact_dot(n, minus(exact_[v], exact_[c[0]])).is_zero()) return name + " is not planar";
    }
    normals_.push_back(make_direction(std::move(n)));
    if (!turns_one_way(c, normals_.back())) return name + " is concave";
    return std::nullopt;
  }

  // Whether every corner is on or left of every edge, in the projection along the normal's largest component.
  bool turns_one_way(const std::vector<std::uint32_t>& c, const Direction& n) const {
    Eigen::Index k = 0;
    n.approximate.cwiseAbs().maxCoeff(&k);
    const auto x = static_cast<std::size_t>((k + 1) % 3), y = static_cast<std::size_t>((k + 2) % 3);
    const int front = n.approximate[k] > 0.0 ? 1 : -1;
    for (std::size_t i = 0; i < c.size(); ++i) {
      const std::uint32_t a = c[i], b = c[(i + 1) % c.size()];
      for (const std::uint32_t v : c) {
        if (v != a && v != b && front * turn(a, b, v, x, y) < 0) return false;
      }
    }
    return true;
  }

  // Sign of the area of triangle a b v in the x y projection. Filter: Shewchuk's orient2d, (3 + 16u) u.
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t v, std::size_t x, std::size_t y) const {
    const auto coordinate = [&](std::uint32_t i, std::size_t k) {
      return static_cast<double>(surface_.vertices[i][static_cast<Eigen::Index>(k)]);
    };
    const double left = (coordinate(a, x) - coordinate(v, x)) * (coordinate(b, y) - coordinate(v, y));
    const double right = (coordinate(a, y) - coordinate(v, y)) * (coordinate(b, x) - coordinate(v, x));
    if (std::abs(left - right) > 0x1p-51 * (std::abs(left) + std::abs(right))) return left > right ? 1 : -1;
    const Integer area = (exact_[a][x] - exact_[v][x]) * (exact_[b][y] - exact_[v][y]) -
                         (exact_[a][y] - exact_[v][y]) * (exact_[b][x] - exact_[v][x]);
    return area.sign();
  }

  // Requires every edge to belong to two polygons, and all polygons to be connected over edges.
  Refusal examine_edges() {
    const std::size_t count = surface_.polygons.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::vector<std::uint32_t>& c = surface_.polygons[i];
      for (std::size_t j = 0; j < c.size(); ++j) {
        const Edge edge = std::minmax(c[j], c[(j + 1) % c.size()]);
        edges_[edge].push_back(static_cast<std::uint32_t>(i));
      }
    }
    for (const auto& [edge, owners] : edges_) {
      if (owners.size() == 1) return "open surface";
    }
    for (const auto& [edge, owners] : edges_) {
      if (owners.size() > 2) return "more than two polygons share an edge";
    }
    std::vector<std::uint32_t> part(count);
    std::iota(part.begin(), part.end(), 0U);
    const auto root = [&](std::uint32_t i) {
      while (part[i] != i) i = part[i] = part[part[i]];
      return i;
    };
    assert(std::ranges::all_of(edges_, [](const auto& edge) { return edge.second.size() == 2; }));
    for (const auto& [edge, owners] : edges_) part[root(owners[0])] = root(owners[1]);
    for (std::uint32_t i = 1; i < count; ++i) {
      if (root(i) != root(0)) return "several parts";
    }
    return std::nullopt;
  }

  // Requires all vertices to be on one side of every polygon's plane; the polygon is turned so that this is its back.
  Refusal examine_sides() {
    on_plane_.assign(surface_.polygons.size(), std::vector<bool>(surface_.vertices.size()));
    for (std::size_t i = 0; i < surface_.polygons.size(); ++i) {
      bool in_front = false, behind = false;
      for (std::uint32_t v = 0; v < surface_.vertices.size(); ++v) {
        const int side = side_of(i, v);
        on_plane_[i][v] = side == 0;
        in_front |= side > 0;
        behind |= side < 0;
        if (in_front && behind) return "concave";
      }
      if (!in_front && !behind) return "several polygons in one plane";
      if (in_front) turn_over(i);
    }
    return std::nullopt;
  }

  // Filter: each of the three products has a relative error < 12u (normal 7u, difference u, product u, sums 2u), so
  // that a sum above 16u of the absolute products has the right sign.
  int side_of(std::size_t polygon, std::uint32_t v) const {
    const std::uint32_t corner = surface_.polygons[polygon][0];
    const Vec3 d = surface_.vertices[v].cast<double>() - surface_.vertices[corner].cast<double>();
    const Vec3 products = normals_[polygon].approximate.cwiseProduct(d);
    const double sum = products.x() + products.y() + products.z();
    if (std::abs(sum) > 0x1p-49 * products.cwiseAbs().sum()) return sum > 0.0 ? 1 : -1;
    return exact_dot(normals_[polygon].exact, minus(exact_[v], exact_[corner])).sign();
  }

  // With every polygon facing outward, the two owners of an edge run along it in opposite directions. If not, the
  // surface folds back on itself and covers a part of its hull twice.
  Refusal examine_orientation() const {
    std::vector<Edge> directed;
    for (const std::vector<std::uint32_t>& c : surface_.polygons) {
      for (std::size_t j = 0; j < c.size(); ++j) directed.emplace_back(c[j], c[(j + 1) % c.size()]);
    }
    std::ranges::sort(directed);
    if (std::ranges::adjacent_find(directed) != directed.end()) return "the surface folds back on itself";
    return std::nullopt;
  }

  void turn_over(std::size_t i) {
    assert(i < normals_.size() && surface_.polygons[i].size() >= 3);
    std::reverse(surface_.polygons[i].begin() + 1, surface_.polygons[i].end());
    normals_[i].approximate = -normals_[i].approximate;
    for (Integer& x : normals_[i].exact) x = -x;
  }

  // An edge between two polygons of one plane is a seam, not an edge of the polyhedron.
  bool is_seam(const std::vector<std::uint32_t>& owners) const {
    return std::ranges::all_of(surface_.polygons[owners[1]], [&](std::uint32_t v) { return on_plane_[owners[0]][v]; });
  }

  void choose_axes() {
    for (std::uint32_t i = 0; i < normals_.size(); ++i) {
      const auto same = [&](std::uint32_t j) { return parallel(normals_[i], normals_[j]); };
      if (std::ranges::none_of(surface_.face_axes, same)) surface_.face_axes.push_back(i);
    }
    std::vector<Direction> chosen;
    for (std::size_t i = 0; i < surface_.polygons.size(); ++i) {  // in file order, so that peers agree on the order
      const std::vector<std::uint32_t>& c = surface_.polygons[i];
      for (std::size_t j = 0; j < c.size(); ++j) {
        const std::uint32_t a = c[j], b = c[(j + 1) % c.size()];
        if (!surface_.flat()) {
          const std::vector<std::uint32_t>& owners = edges_.at(std::minmax(a, b));
          if (owners[0] != i || is_seam(owners)) continue;
        }
        Direction d = make_direction(minus(exact_[b], exact_[a]));
        if (std::ranges::any_of(chosen, [&](const Direction& other) { return parallel(d, other); })) continue;
        chosen.push_back(std::move(d));
        surface_.edge_axes.push_back({a, b});
      }
    }
  }

  const Mesh& mesh_;
  ConvexSurface surface_;
  std::vector<Integer3> exact_;                       // surface_.vertices, times one power of two
  std::vector<Direction> normals_;                    // of the polygons
  std::map<Edge, std::vector<std::uint32_t>> edges_;  // polygons by (lesser, greater) vertex
  std::vector<std::vector<bool>> on_plane_;           // [polygon][vertex]
};

}  // namespace

std::expected<ConvexSurface, std::string> convex_surface(const Mesh& mesh) {
  assert(mesh.polygon_count() > 0);
  return ConvexityTest(mesh).run();
}

}  // namespace peerd::collision
