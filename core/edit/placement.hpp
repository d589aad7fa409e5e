#pragma once
#include <optional>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/scene/scene.hpp"
#include "core/transform.hpp"

namespace peerd {

// The fields by which the rigid pose (Scene::rigid_pose) of an instance becomes `world` [m, world frame], as near as
// binary32 numbers can say it, where all above it stands as the scene has it. None: the instance is no Transform, its
// node stands in other places, too, or what is above it is flat.
[[nodiscard]] std::optional<Placement> placement_of(const Scene& scene, ObjectId instance, const Pose& world);

}  // namespace peerd
