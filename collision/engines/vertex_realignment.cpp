#include "collision/engines/vertex_realignment.hpp"
#include "collision/volumes/convex_hull.hpp"

namespace peerd::collision::engines {

std::vector<Vec3> hull_of(const TriangleSoup& soup) {
  std::vector<bool> used(soup.vertices.size());
  for (const TriangleSoup::Face& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) used[corner] = true;
  }
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) points.push_back(soup.vertices[i]);
  }
  const auto hull = convex_hull(points);
  return hull ? hull->corners : points;
}

}  // namespace peerd::collision::engines
