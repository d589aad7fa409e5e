#pragma once
#include "core/geometry/geometry.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd {

// ISO/IEC 14772-1, 6.17: quadrilateral i + j (x_dimension - 1) has the grid's points [i, j], [i, j + 1], [i + 1, j +
// 1], [i + 1, j], counter-clockwise seen from above.
[[nodiscard]] Mesh build_elevation_grid(const ElevationGridGeometry& grid);
[[nodiscard]] MeshSize elevation_grid_size(const ElevationGridGeometry& grid);

}  // namespace peerd
