#include "core/motion/carriers.hpp"

#include <cassert>

namespace peerd {

Carriers::Carriers(const Scene& scene, const PredefinedMotion& motion, std::span<const ObjectId> movable)
    : scene_(scene), nodes_(scene.instances.size()) {
  for (const ObjectId id : movable) nodes_[scene.index_of(id)].is_carrier = true;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    const ObjectId id = scene.id_of(i);
    const std::int32_t parent = scene.instances[i].parent;
    if (parent >= 0) {
      const auto p = static_cast<std::uint32_t>(parent);
      assert(p < i && "instances stand in depth-first order");
      node.above = nodes_[p].is_carrier ? p : nodes_[p].above;
      node.distorted = nodes_[p].distorted;
      node.uneven = nodes_[p].uneven;
    }
    node.distorted = node.distorted || motion.scales(id) || (node.uneven && motion.turns_in_parent(id));
    node.is_carrier = !node.distorted && (node.is_carrier || motion.moves_in_parent(id));
    const Vec3& scale = scene.transform(id).scale;
    node.uneven = node.uneven || scale.x() != scale.y() || scale.y() != scale.z();
  }
}

}  // namespace peerd
