#pragma once
#include "core/geometry/geometry.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd {

// The polygons of a geometry in its Shape's frame, as the standard (ISO/IEC 14772-1:1997, clause 6) defines them; they
// have the corners that the geometry has, and share vertices. Counter-clockwise seen from outside; `ccw` FALSE is in
// Mesh::ccw and leaves the corners as they are. Computed in binary64 and rounded once, by operations that IEEE 754
// defines, so that peers get the same bits; coordinates that would be infinite are the largest finite ones. At most
// 2^31 - 1 corners, polygon ends included: the caller has asked mesh_size() before, and refuses worlds far below that.
[[nodiscard]] Mesh build_mesh(const Geometry& geometry, const Tessellation& tessellation = {});

// The number of polygons and triangles that build_mesh() would give, without building anything.
[[nodiscard]] MeshSize mesh_size(const Geometry& geometry, const Tessellation& tessellation = {});

}  // namespace peerd
