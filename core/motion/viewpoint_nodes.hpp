#pragma once
#include <optional>

#include "core/scene/scene.hpp"

namespace peerd {

// A Viewpoint node where it stands in the scene (ISO/IEC 14772-1, 6.53).
struct ViewpointNode {
  std::optional<ObjectId> parent;   // the instance that it stands in; none: at the top level
  Pose in_world;                    // of the camera, as the file places it; rigid (Scene::rigid_pose())
  double field_of_view = 0.785398;  // the smaller of the angles of width and height [rad], in (0, pi)
};

// Returns the Viewpoint that is bound when the world is loaded: the first one in the file (ISO/IEC 14772-1, 4.6.10),
// and what a Switch has not chosen and lower levels of an LOD aside, which are not in the world. None: there is none. A
// fieldOfView that is none is taken for the default.
[[nodiscard]] std::optional<ViewpointNode> bound_viewpoint(const Scene& scene);

}  // namespace peerd
