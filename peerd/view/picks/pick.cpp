#include "peerd/view/picks/pick.hpp"

#include <cassert>
#include <utility>

#include "collision/scene/scene_query.hpp"
#include "peerd/view/picks/node_place.hpp"

namespace peerd::view {
namespace {

// The nearest Transform at or above an instance; the instance itself where there is none.
ObjectId transform_at(const Scene& scene, ObjectId shape) {
  for (std::optional<ObjectId> id = shape; id; id = scene.parent_of(*id)) {
    if (scene.at(*id).kind == NodeKind::kTransform) return *id;
  }
  return shape;
}

TransformFields rigid(const Pose& pose) {
  TransformFields fields;
  fields.translation = pose.position;
  fields.rotation = pose.orientation;
  return fields;
}

}  // namespace

// A scene with the same geometries in which each mover is a Transform at the top, and what goes with it is below:
//   Transform (the node of the picture) -- Transform (translation, rotation, scale) -- Transform (inner rotation) --
//   Shape
struct ScenePicker::Parts {
  Scene flat;
  std::vector<ObjectId> shape_of;           // by instance of `flat`: the Shape of the world's scene
  std::vector<ObjectId> object_of;          // and the object of a hit of it
  std::vector<std::uint32_t> node_of;       // and its node
  std::vector<std::uint32_t> transform_of;  // by node, into Scene::transforms
  std::optional<collision::SceneQuery> query;

  std::uint32_t add_transform(std::int32_t parent, const TransformFields& fields) {
    Instance instance;
    instance.kind = NodeKind::kTransform;
    instance.transform = static_cast<std::uint32_t>(flat.transforms.size());
    flat.transforms.push_back(fields);
    return add(parent, instance);
  }
  std::uint32_t add(std::int32_t parent, Instance instance) {
    const auto index = static_cast<std::uint32_t>(flat.instances.size());
    instance.parent = parent;
    flat.instances.push_back(instance);
    for (auto i = static_cast<std::int32_t>(index); i >= 0; i = flat.instances[static_cast<std::uint32_t>(i)].parent) {
      flat.instances[static_cast<std::uint32_t>(i)].subtree_end = index + 1;
    }
    shape_of.emplace_back();
    object_of.emplace_back();
    node_of.push_back(0);
    return index;
  }
};

ScenePicker::ScenePicker(const PictureInput& input, Pickable what) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  const Scene& scene = input.scene;
  p.flat.geometries = scene.geometries;
  p.flat.shape_fields = scene.shape_fields;
  p.flat.tessellation = scene.tessellation;
  p.flat.document = scene.document;
  const auto standing = static_cast<std::uint32_t>(input.movers.size());
  std::vector<std::uint32_t> node_of(scene.instances.size(), standing);
  std::vector<std::vector<std::uint32_t>> shapes(standing + 1U);  // by node
  std::uint32_t next = 0;                                         // mover
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.parent >= 0) node_of[i] = node_of[static_cast<std::uint32_t>(instance.parent)];
    if (next < standing && scene.index_of(input.movers[next].id) == i) node_of[i] = next++;
    const bool is_met = what == Pickable::kDrawn ? instance.drawn : instance.collides;
    if (instance.kind == NodeKind::kShape && is_met && instance.geometry != Instance::kNone) {
      shapes[node_of[i]].push_back(i);
    }
  }
  assert(next == standing && "movers stand depth-first");
  for (std::uint32_t node = 0; node <= standing; ++node) {
    const auto root = static_cast<std::int32_t>(
        p.add_transform(-1, node < standing ? rigid(input.movers[node].pose) : TransformFields{}));
    p.transform_of.push_back(p.flat.instances[static_cast<std::uint32_t>(root)].transform);
    for (const std::uint32_t i : shapes[node]) {
      const ObjectId id = scene.id_of(i);
      const Eigen::Affine3d map =
          node < standing ? scene.object_from_shape(input.movers[node].id, id) : scene.world_from_local(id);
      if (!map.matrix().allFinite()) continue;  // it is not drawn either
      const NodePlace at = place_of(map);
      TransformFields fields = rigid({at.translation, at.rotation});
      fields.scale = at.scale;
      std::int32_t parent = root;
      if (!at.map().isApprox(Eigen::Affine3d::Identity(), 0.0)) {
        parent = static_cast<std::int32_t>(p.add_transform(parent, fields));
      }
      if (at.inner) parent = static_cast<std::int32_t>(p.add_transform(parent, rigid({Vec3::Zero(), *at.inner})));
      Instance shape = scene.instances[i];
      shape.drawn = true;
      const std::uint32_t index = p.add(parent, shape);
      p.shape_of[index] = id;
      p.object_of[index] = node < standing ? input.movers[node].id : transform_at(scene, id);
      p.node_of[index] = node;
    }
  }
  p.query.emplace(p.flat);
}

ScenePicker::~ScenePicker() = default;

void ScenePicker::place(std::uint32_t node, const Pose& pose) {
  assert(node < parts_->transform_of.size());
  parts_->query->move(parts_->transform_of[node], rigid(pose));
}

std::expected<std::optional<PickHit>, std::string> ScenePicker::pick(const Vec3& origin, const Vec3& direction) {
  const auto found = parts_->query->pick(origin, direction);
  if (!found) return std::unexpected(found.error());
  if (!*found) return std::nullopt;
  const collision::Pick& hit = **found;
  const std::uint32_t index = parts_->flat.index_of(hit.at.shape);
  return PickHit{parts_->node_of[index], parts_->object_of[index], parts_->shape_of[index], hit.at.polygon,
                 hit.distance_m,         hit.point_world,          hit.normal_world};
}

}  // namespace peerd::view
