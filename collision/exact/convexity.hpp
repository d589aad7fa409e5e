#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "core/geometry/mesh.hpp"
#include "core/math.hpp"

namespace peerd::collision {

// The surface of a Mesh that is a closed convex polyhedron, or one flat convex polygon, in the Shape's frame [m].
struct ConvexSurface {
  std::vector<Eigen::Vector3f> vertices;                // the vertices in use, one of each position
  std::vector<std::vector<std::uint32_t>> polygons;     // polygon i of the mesh, counter-clockwise seen from outside
  std::vector<Vec3> normals;                            // unit outward normals, by polygon
  std::vector<std::uint32_t> face_axes;                 // the least polygon of each set of parallel ones
  std::vector<std::array<std::uint32_t, 2>> edge_axes;  // one true edge of each set of parallel ones

  [[nodiscard]] bool flat() const { return polygons.size() == 1; }
};

// The convex surface of a mesh with at least one polygon, or why the mesh has none ("concave", "open surface", and so
// on). The decision is exact for the binary32 vertices as parsed: a floating-point filter with a proven bound decides,
// then integers.
[[nodiscard]] std::expected<ConvexSurface, std::string> convex_surface(const Mesh& mesh);

// Two pieces with 256 polygons each have up to 384 x 384 pairs of edges, and each is a separating-axis candidate that
// reads up to 512 vertices: some 50 ms, already more than a tick. A mesh with more is left to a hierarchy.
inline constexpr std::size_t kMaxPiecePolygons = 256;
// A convex polyhedron of 256 faces has at most 2 * 256 - 4 corners (Euler); a flat polygon is held to the same.
inline constexpr std::size_t kMaxPieceVertices = 2 * kMaxPiecePolygons;

}  // namespace peerd::collision
