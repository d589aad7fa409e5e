#pragma once
#include "core/geometry/geometry.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd {

// Builds an Extrusion (ISO/IEC 14772-1, 6.18). Its polygons are the quadrilaterals of the side, segment after segment
// of the spine and edge after edge of the cross-section in each, then the cap at the begin of the spine, then the one
// at its end.
[[nodiscard]] Mesh build_extrusion(const ExtrusionGeometry& extrusion);
[[nodiscard]] MeshSize extrusion_size(const ExtrusionGeometry& extrusion);

}  // namespace peerd
