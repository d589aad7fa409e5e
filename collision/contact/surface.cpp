#include "collision/contact/surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/ordered_sums.hpp"

namespace peerd::collision {

std::expected<void, std::string> Surface::append(ObjectId shape, const Mesh& mesh,
                                                 const std::function<Vec3(const Eigen::Vector3f&)>& place) {
  assert(!tree_);
  // The mesh is triangulated in its own frame, so that it is cut as everywhere else.
  const auto cut = make_soup(mesh);
  if (!cut) return std::unexpected(cut.error());
  constexpr std::uint32_t kUnused = ~0u;
  std::expected<void, std::string> good;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnused);
  for (const std::int32_t corner : mesh.corners) {
    if (corner == Mesh::kEndOfPolygon) continue;
    const auto v = static_cast<std::size_t>(corner);
    if (number[v] != kUnused) continue;
    number[v] = static_cast<std::uint32_t>(soup_.vertices.size());
    const Vec3 there = place(mesh.vertices[v]);
    if (!is_representable(there) && good) {
      good = std::unexpected("vertex " + std::to_string(v) + " is not within 2^128 m of its object's origin");
    }
    soup_.vertices.push_back(there);
    soup_.box.merge(there);
  }
  if (!good) return good;
  for (const TriangleSoup::Face& face : cut->faces) {
    const auto& c = face.corners;
    soup_.faces.push_back({{number[c[0]], number[c[1]], number[c[2]]}, polygons_ + face.polygon});
  }
  assert(soup_.faces.empty() || soup_.faces.back().polygon < polygons_ + mesh.polygon_count());
  shapes_.emplace_back(polygons_, shape);
  polygons_ += static_cast<std::uint32_t>(mesh.polygon_count());
  return {};
}

ShapePolygon Surface::polygon(std::uint32_t of_soup) const {
  assert(of_soup < polygons_);
  const auto after = std::ranges::upper_bound(shapes_, of_soup, {}, &std::pair<std::uint32_t, ObjectId>::first);
  assert(after != shapes_.begin());
  const auto& [first, shape] = *(after - 1);
  return {shape, of_soup - first};
}

std::optional<Vec3> Surface::normal(std::uint32_t polygon_of_soup) const {
  const auto faces = std::ranges::equal_range(soup_.faces, polygon_of_soup, {}, &TriangleSoup::Face::polygon);
  assert(polygon_of_soup < polygons_);
  Vec3 sum = Vec3::Zero();
  for (const TriangleSoup::Face& face : faces) {
    const Vec3 &p = soup_.vertices[face.corners[0]], &q = soup_.vertices[face.corners[1]],
               &r = soup_.vertices[face.corners[2]];
    sum += Vec3(q - p).cross(r - p);
  }
  const double size = length(sum);
  if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
  return Vec3(sum / size);
}

WideTree& Surface::tree() {
  assert(!soup_.faces.empty());
  if (!tree_) tree_.emplace(soup_);
  return *tree_;
}

}  // namespace peerd::collision
