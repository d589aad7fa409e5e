#include "collision/contact/containment.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "collision/contact/box_contact.hpp"
#include "collision/contact/mesh_contact.hpp"

namespace peerd::collision {
namespace {

// Equal numbers for vertices at one place.
std::vector<std::uint32_t> places_of(std::span<const Vec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size()), places(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto less = [&](std::uint32_t i, std::uint32_t k) {
    return std::ranges::lexicographical_compare(vertices[i], vertices[k]);
  };
  std::ranges::sort(order, less);
  for (std::size_t i = 1; i < order.size(); ++i) {
    places[order[i]] = places[order[i - 1]] + (less(order[i - 1], order[i]) ? 1U : 0U);
  }
  return places;
}

}  // namespace

bool is_closed(const TriangleSoup& soup) {
  const std::vector<std::uint32_t> places = places_of(soup.vertices);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const TriangleSoup::Face& face : soup.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = places[face.corners[i]], to = places[face.corners[(i + 1) % 3]];
      if (from != to) edges.emplace_back(std::min(from, to), std::max(from, to));
    }
  }
  std::ranges::sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    const std::size_t begin = i;
    while (i < edges.size() && edges[i] == edges[begin]) ++i;
    if ((i - begin) % 2 != 0) return false;
  }
  return !edges.empty();
}

double winding_number(const TriangleSoup& soup, const Vec3& point) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < soup.faces.size(); ++i) {
    const Triangle triangle = soup.triangle(i);
    const Vec3 a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    // A. Van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", 1983.
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

bool is_inside(const MovingBody& inner, const MovingBody& outer) {
  if (inner.body.vertices().empty() || outer.body.vertices().empty()) return false;
  const WorldBox of_inner = tight_box(inner), of_outer = tight_box(outer);
  for (int k = 0; k < 3; ++k) {
    if (of_inner.lo[k] < of_outer.lo[k] || of_inner.hi[k] > of_outer.hi[k]) return false;
  }
  if (surfaces_within(inner, outer, 0.0)) return false;
  const Pose from = inner.motion.pose(), to = outer.motion.pose();
  const Vec3 place = to.orientation.conjugate() * (from * inner.body.vertices().front() - to.position);
  return std::abs(winding_number(outer.body.surface->soup(), place)) > 0.5;
}

}  // namespace peerd::collision
