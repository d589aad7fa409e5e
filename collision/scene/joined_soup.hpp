#pragma once
#include <cstddef>
#include <expected>
#include <optional>
#include <string>

#include "collision/exact/triangle_soup.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// The triangles of all Shapes at and below an object that collide, as one soup in the object's rigid frame [m]; of all
// Shapes of the scene in the world frame where no object is given. Vertices are rounded by the maps to that frame.
// Polygons are numbered through, Shape by Shape in file order. Empty where nothing collides. The error says that there
// are more than `triangles_max`, or which vertex is too far out.
[[nodiscard]] std::expected<TriangleSoup, std::string> joined_soup(const Scene& scene, std::optional<ObjectId> object,
                                                                   std::size_t triangles_max);

}  // namespace peerd::collision
