#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/motion/carriers.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"

namespace peerd::view {

// MovingForms are what of a world is no rigid body as the world moves: geometries whose Coordinate a ROUTE drives, and
// Shapes below a driven scale, or turned below an uneven one. Each goes by its place in its list.
struct MovingForms {
  std::vector<std::uint32_t> geometries;  // into Scene::geometries, ascending
  std::vector<ObjectId> shapes;           // depth-first

  [[nodiscard]] std::optional<std::uint32_t> of_geometry(std::uint32_t geometry) const;
  [[nodiscard]] std::optional<std::uint32_t> of_shape(ObjectId shape) const;
};

[[nodiscard]] MovingForms moving_forms(const Scene& scene, const PredefinedMotion& motion, const Carriers& carriers);

}  // namespace peerd::view
