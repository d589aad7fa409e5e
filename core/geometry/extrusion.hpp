#pragma once
#include "core/geometry/geometry.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd {

// ISO/IEC 14772-1, 6.18. Polygons: the side's quadrilaterals, segment after segment of the spine and edge after edge of
// the cross-section in each, then the cap at the spine's begin, then the one at its end.
[[nodiscard]] Mesh build_extrusion(const ExtrusionGeometry& extrusion);
[[nodiscard]] MeshSize extrusion_size(const ExtrusionGeometry& extrusion);

}  // namespace peerd
