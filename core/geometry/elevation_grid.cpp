#include "core/geometry/elevation_grid.hpp"

#include <cassert>

#include "core/geometry/polygon_writer.hpp"

namespace peerd {

MeshSize elevation_grid_size(const ElevationGridGeometry& grid) {
  if (grid.x_dimension < 2 || grid.z_dimension < 2) return {};
  const std::uint64_t quadrilaterals =
      static_cast<std::uint64_t>(grid.x_dimension - 1) * static_cast<std::uint64_t>(grid.z_dimension - 1);
  return {quadrilaterals, 2 * quadrilaterals};
}

Mesh build_elevation_grid(const ElevationGridGeometry& grid) {
  const MeshSize size = elevation_grid_size(grid);
  if (size.polygons == 0) return {};
  const auto columns = static_cast<std::uint64_t>(grid.x_dimension),
             rows = static_cast<std::uint64_t>(grid.z_dimension);
  assert(grid.height.size() == columns * rows);

  PolygonWriter out(columns * rows, size);
  for (std::uint64_t j = 0; j < rows; ++j) {
    for (std::uint64_t i = 0; i < columns; ++i) {  // the products are exact
      out.vertex(static_cast<double>(grid.x_spacing) * static_cast<double>(i), grid.height[i + j * columns],
                 static_cast<double>(grid.z_spacing) * static_cast<double>(j));
    }
  }
  for (std::uint64_t j = 0; j + 1 < rows; ++j) {
    for (std::uint64_t i = 0; i + 1 < columns; ++i) {
      const std::uint64_t at = i + j * columns;
      out.polygon({at, at + columns, at + columns + 1, at + 1});
    }
  }
  return std::move(out).finish(grid.ccw);
}

}  // namespace peerd
