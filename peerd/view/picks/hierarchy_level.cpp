#include "peerd/view/picks/hierarchy_level.hpp"

#include <cassert>
#include <utility>

#include <nlohmann/json.hpp>

#include "collision/scene/joined_soup.hpp"
#include "collision/tree/kdop_tree.hpp"
#include "collision/tree/kdop_volume.hpp"

namespace peerd::view {
namespace {

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
  const auto soup = collision::joined_soup(scene, object, kTrianglesMax);
  if (!soup) return std::unexpected(soup.error());
  if (soup->faces.empty()) return std::unexpected("it has no polygons that collide");
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

}  // namespace peerd::view
