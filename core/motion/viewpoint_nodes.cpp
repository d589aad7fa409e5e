#include "core/motion/viewpoint_nodes.hpp"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <span>
#include <string_view>

#include "core/scene/rotation.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/document.hpp"

namespace peerd {
namespace {

std::string_view field_of_children(NodeKind kind) {
  switch (kind) {
    case NodeKind::kLod:
      return "level";
    case NodeKind::kSwitch:
      return "choice";
    default:
      return "children";
  }
}

class ViewpointFinder {
 public:
  explicit ViewpointFinder(const Scene& scene) : scene_(scene) {}

  [[nodiscard]] std::optional<ViewpointNode> find() const {
    const auto end = static_cast<std::uint32_t>(scene_.instances.size());
    return find_among(scene_.document->top_level, std::nullopt, 0, end);
  }

 private:
  // In depth-first file order; [first, end) are the instances below the parent.
  [[nodiscard]] std::optional<ViewpointNode> find_among(std::span<const vrml::NodeRef> children,
                                                        std::optional<ObjectId> parent, std::uint32_t first,
                                                        std::uint32_t end) const {
    std::uint32_t instance = first;
    for (std::uint32_t i = 0; i < children.size(); ++i) {
      if (!children[i].is_node()) continue;
      const vrml::Node& node = scene_.document->nodes[children[i].index];
      if (node.type->name == "Viewpoint") return at(node, parent);
      if (instance == end || scene_.instances[instance].child_index != i) continue;
      if (const auto below = find_below(scene_.id_of(instance))) return below;
      instance = scene_.instances[instance].subtree_end;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<ViewpointNode> find_below(ObjectId id) const {
    const Instance& instance = scene_.at(id);
    if (instance.kind == NodeKind::kShape || instance.node == Instance::kNone || !instance.drawn) return std::nullopt;
    const vrml::Field* const field = scene_.document->nodes[instance.node].find(field_of_children(instance.kind));
    if (field == nullptr) return std::nullopt;
    std::span<const vrml::NodeRef> children = field->as<vrml::NodeRef>();
    if (instance.kind == NodeKind::kLod) children = children.first(std::min<std::size_t>(1, children.size()));
    return find_among(children, id, scene_.index_of(id) + 1, instance.subtree_end);
  }

  [[nodiscard]] ViewpointNode at(const vrml::Node& node, std::optional<ObjectId> parent) const {
    const auto position = value_of(node, "position").as<float>();
    const auto orientation = value_of(node, "orientation").as<float>();
    assert(position.size() == 3 && orientation.size() == 4);
    const Vec3 local(position[0], position[1], position[2]);
    const Quat turned = vrml::to_quat(orientation.first<4>());
    ViewpointNode out{parent, {local, turned}};
    if (parent) {
      const Pose above = scene_.rigid_pose(*parent);
      out.in_world = {scene_.world_from_local(*parent) * local, (above.orientation * turned).normalized()};
    }
    const double angle = value_of(node, "fieldOfView").as<float>()[0];
    if (angle > 0.0 && angle < std::numbers::pi) out.field_of_view = angle;
    return out;
  }

  const Scene& scene_;
};

}  // namespace

std::optional<ViewpointNode> bound_viewpoint(const Scene& scene) {
  if (scene.document == nullptr) return std::nullopt;
  return ViewpointFinder(scene).find();
}

}  // namespace peerd
