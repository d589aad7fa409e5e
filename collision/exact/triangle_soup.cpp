#include "collision/exact/triangle_soup.hpp"

#include <cmath>

#include "core/geometry/triangulation.hpp"
#include "core/transform.hpp"

namespace peerd::collision {
bool is_representable(const Vec3& v) {
  // Not one comparison holds for what is no number.
  return std::abs(v[0]) <= kLargestCoordinate_m && std::abs(v[1]) <= kLargestCoordinate_m &&
         std::abs(v[2]) <= kLargestCoordinate_m;
}

std::expected<TriangleSoup, std::string> make_soup(const Mesh& mesh, const Mat3& stretch) {
  TriangleSoup soup;
  const bool stretched = stretch != Mat3::Identity();
  soup.vertices.reserve(mesh.vertices.size());
  bool all_places = true;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    const Vec3 parsed = v.cast<double>();
    soup.vertices.push_back(stretched ? multiply(stretch, parsed) : parsed);
    all_places &= is_representable(soup.vertices.back());
  }
  soup.faces.reserve(mesh.polygon_count());
  std::vector<std::uint8_t> used(mesh.vertices.size());  // a byte is set in one step, a bit in three
  Triangulator triangulator;
  for (std::uint32_t polygon = 0; polygon < mesh.polygon_count(); ++polygon) {
    const auto corners = mesh.polygon(polygon);
    for (const std::int32_t corner : corners) {
      used[static_cast<std::size_t>(corner)] = 1;
      if (!all_places && !is_representable(soup.vertices[static_cast<std::size_t>(corner)])) {
        return std::unexpected("vertex " + std::to_string(corner) + " of polygon " + std::to_string(polygon) +
                               " is not within 2^128 m of its Shape's origin");
      }
    }
    for (const CornerTriangle& t : triangulator.triangulate(mesh, polygon)) {
      const auto vertex = [&](std::uint32_t i) { return static_cast<std::uint32_t>(corners[i]); };
      soup.faces.push_back({{vertex(t[0]), vertex(t[1]), vertex(t[2])}, polygon});
    }
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) soup.box.merge(soup.vertices[v]);
  }
  return soup;
}

}  // namespace peerd::collision
