#include "core/edit/placement.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace peerd {

std::optional<Placement> placement_of(const Scene& scene, ObjectId instance, const Pose& world) {
  const Instance& placed = scene.at(instance);
  if (placed.transform == Instance::kNone) return std::nullopt;
  if (std::ranges::count(scene.instances, placed.node, &Instance::node) > 1) return std::nullopt;
  TransformFields fields = scene.transform(instance);
  Vec3 origin = world.position;  // in the frame of the parent
  fields.rotation = world.orientation;
  if (const auto parent = scene.parent_of(instance)) {
    const Eigen::Affine3d above = scene.world_from_local(*parent);
    if (above.linear().determinant() == 0) return std::nullopt;
    origin = above.inverse() * origin;
    fields.rotation = scene.rigid_pose(*parent).orientation.conjugate() * fields.rotation;
  }
  fields.translation = Vec3::Zero();
  const Eigen::Vector3f translation = (origin - parent_from_local(fields).offset).cast<float>();
  if (!translation.allFinite()) return std::nullopt;
  const Eigen::AngleAxisf turn(Eigen::AngleAxisd(fields.rotation).cast<float>());
  return Placement{{translation.x(), translation.y(), translation.z()},
                   {turn.axis().x(), turn.axis().y(), turn.axis().z(), turn.angle()}};
}

}  // namespace peerd
