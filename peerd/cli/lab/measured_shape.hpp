#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "collision/engines/engine.hpp"
#include "collision/exact/triangle_soup.hpp"
#include "core/box.hpp"

namespace peerd {

struct OverTurns {
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0, sum = 0.0;
  void add(double value);
};

// The volumes around a shape, in % of its convex hull's.
struct ShapeTightness {
  std::size_t hull_corners = 0;
  double hull_m3 = 0.0;
  double box = 0.0, ball = 0.0;                 // oriented box and bounding sphere, which turn with the shape
  OverTurns kdop{}, aabb{};                     // around the turned hull
  std::vector<std::array<double, 2>> turned{};  // 18-DOP and AABB, by rotation
};

struct MeasuredHierarchy {
  collision::engines::KdopOptions options;
  std::uint32_t height = 0, least_height = 0;  // levels below the root; of a balanced tree
  std::size_t nodes = 0, bytes = 0;
  double build_s = 0.0;  // wall-clock time
  std::vector<double> level_percent{};
};

struct MeasuredShape {
  std::string path;
  std::size_t polygons = 0, triangles = 0, vertices = 0;
  WorldBox box{};                             // of the vertices that polygons use, in the frame of the shape
  std::optional<ShapeTightness> tightness{};  // none where the shape is flat
  std::vector<MeasuredHierarchy> hierarchies{};
};

// The measures of VolumesOptions (volumes_command.hpp) of a soup with a face: at seven full turns of `steps` rotations,
// and of a tree of each choice of options; `levels`: with the volumes of its levels.
[[nodiscard]] MeasuredShape measure_shape(std::string path, const collision::TriangleSoup& soup, std::uint32_t steps,
                                          const std::vector<collision::engines::KdopOptions>& hierarchies, bool levels);

}  // namespace peerd
