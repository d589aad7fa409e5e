#include "peerd/insight/hierarchy_level.hpp"

#include <cassert>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "collision/exact/triangle_soup.hpp"
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/kdop_volume.hpp"
#include "core/geometry/tessellate.hpp"

namespace peerd::insight {
namespace {

// The polygons of all Shapes at and below the object that collide, in its frame.
std::expected<collision::TriangleSoup, std::string> soup_of(const Scene& scene, ObjectId object) {
  const std::uint32_t first = scene.index_of(object);
  collision::TriangleSoup all;
  for (std::uint32_t i = first; i < scene.instances[first].subtree_end; ++i) {
    const ObjectId id = scene.id_of(i);
    const Geometry* const geometry = scene.instances[i].collides ? scene.geometry(id) : nullptr;
    if (geometry == nullptr || std::holds_alternative<NoSurface>(*geometry)) continue;
    auto soup = collision::make_soup(build_mesh(*geometry, scene.tessellation));
    if (!soup) return std::unexpected(soup.error());
    if (all.faces.size() + soup->faces.size() > kTrianglesMax) {
      return std::unexpected("it has more than " + std::to_string(kTrianglesMax) + " triangles");
    }
    const Eigen::Affine3d place = scene.object_from_shape(object, id);
    const auto begin = static_cast<std::uint32_t>(all.vertices.size());
    for (const Vec3& vertex : soup->vertices) {
      all.vertices.push_back(place * vertex);
      if (!collision::is_representable(all.vertices.back())) return std::unexpected("a vertex of it is too far out");
    }
    for (collision::TriangleSoup::Face face : soup->faces) {
      for (std::uint32_t& corner : face.corners) corner += begin;
      all.faces.push_back(face);
    }
  }
  if (all.faces.empty()) return std::unexpected("it has no polygons that collide");
  return all;
}

collision::WideKdop<18> widened(const collision::Kdop<18>& dop) {
  collision::WideKdop<18> out{};
  for (std::size_t i = 0; i < dop.kSlabs; ++i) {
    out.lo[i] = static_cast<double>(dop.lo[i]);
    out.hi[i] = static_cast<double>(dop.hi[i]);
  }
  return out;
}

// Gathers the nodes of one level, from left to right.
class LevelWalk {
 public:
  LevelWalk(collision::KdopTree<18>& tree, std::uint32_t level, HierarchyLevel& out)
      : tree_(tree), level_(level), out_(out) {
    out_.is_last = true;
  }
  void visit(std::uint32_t node, std::uint32_t depth) {
    const std::uint32_t left = tree_.children(node);
    if (left != collision::KdopTree<18>::kLeaf && depth < level_) {
      visit(left, depth + 1);
      visit(left + 1, depth + 1);
      return;
    }
    out_.is_last = out_.is_last && left == collision::KdopTree<18>::kLeaf;
    if (out_.volumes.size() == kVolumes) {
      ++out_.left_out;
    } else {
      out_.volumes.push_back(collision::boundary(widened(tree_.node(node).dop)));
    }
  }

 private:
  collision::KdopTree<18>& tree_;
  std::uint32_t level_;
  HierarchyLevel& out_;
};

}  // namespace

std::expected<HierarchyLevel, std::string> hierarchy_level(const Scene& scene, ObjectId object, std::uint32_t level) {
  assert(level <= kLevels);
  const auto soup = soup_of(scene, object);
  if (!soup) return std::unexpected(soup.error());
  HierarchyLevel out;
  out.triangles = soup->faces.size();
  collision::KdopTree<18> tree(*soup, {});
  LevelWalk(tree, level, out).visit(collision::KdopTree<18>::kRoot, 0);
  return out;
}

nlohmann::ordered_json to_json(const HierarchyLevel& level) {
  nlohmann::ordered_json volumes = nlohmann::ordered_json::array();
  for (const auto& faces : level.volumes) {
    nlohmann::ordered_json& volume = volumes.emplace_back(nlohmann::ordered_json::array());
    for (const HierarchyLevel::Polygon& polygon : faces) {
      nlohmann::ordered_json& face = volume.emplace_back(nlohmann::ordered_json::array());
      for (const Vec3& corner : polygon) {  // binary32 is enough for a picture, and shorter
        for (int axis = 0; axis < 3; ++axis) face.push_back(static_cast<float>(corner[axis]));
      }
    }
  }
  return {{"volumes", std::move(volumes)},
          {"is_last", level.is_last},
          {"left_out", level.left_out},
          {"triangles", level.triangles}};
}

}  // namespace peerd::insight
