#include "collision/scene/joined_soup.hpp"

#include <cassert>
#include <cstdint>
#include <variant>

#include "collision/scene/surfaces.hpp"
#include "core/geometry/tessellate.hpp"

namespace peerd::collision {
namespace {

// Appends a Shape's triangles, its vertices taken to the joined frame. False where one leads out of what is accepted.
bool append(const TriangleSoup& shape, const Eigen::Affine3d& place, std::uint32_t first_polygon, TriangleSoup& all) {
  const auto begin = static_cast<std::uint32_t>(all.vertices.size());
  for (const Vec3& vertex : shape.vertices) {
    all.vertices.push_back(place * vertex);
    if (!is_representable(all.vertices.back())) return false;
  }
  for (TriangleSoup::Face face : shape.faces) {
    face.polygon += first_polygon;
    for (std::uint32_t& corner : face.corners) {
      corner += begin;
      all.box.merge(all.vertices[corner]);
    }
    all.faces.push_back(face);
  }
  assert(all.vertices.size() == begin + shape.vertices.size());
  return true;
}

}  // namespace

std::expected<TriangleSoup, std::string> joined_soup(const Scene& scene, std::optional<ObjectId> object,
                                                     std::size_t triangles_max) {
  const std::uint32_t first = object ? scene.index_of(*object) : 0;
  const std::size_t end = object ? scene.instances[first].subtree_end : scene.instances.size();
  TriangleSoup all;
  std::uint32_t polygons = 0;
  for (std::uint32_t i = first; i < end; ++i) {
    const ObjectId id = scene.id_of(i);
    if (!is_surface(scene, i, Surfaces::kColliding)) continue;
    const Geometry* const geometry = scene.geometry(id);
    if (geometry == nullptr || std::holds_alternative<NoSurface>(*geometry)) continue;
    const Mesh mesh = build_mesh(*geometry, scene.tessellation);
    const auto soup = make_soup(mesh);
    if (!soup) return std::unexpected(soup.error());
    if (soup->faces.size() > triangles_max - all.faces.size()) {
      return std::unexpected("it has more than " + std::to_string(triangles_max) + " triangles");
    }
    const Eigen::Affine3d place = object ? scene.object_from_shape(*object, id) : scene.world_from_local(id);
    if (!append(*soup, place, polygons, all)) return std::unexpected("a vertex of it is too far out");
    polygons += static_cast<std::uint32_t>(mesh.polygon_count());
  }
  assert(all.faces.size() <= triangles_max);
  return all;
}

}  // namespace peerd::collision
