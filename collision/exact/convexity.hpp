#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "core/geometry/mesh.hpp"

namespace peerd::collision {

// A Mesh that is a closed convex polyhedron, or one flat convex polygon. Shape frame.
struct ConvexSurface {
  std::vector<Eigen::Vector3f> vertices;                // those in use, one of each position
  std::vector<std::vector<std::uint32_t>> polygons;     // polygon i of the mesh, counter-clockwise seen from outside
  std::vector<Vec3> normals;                            // of each polygon, outward, unit
  std::vector<std::uint32_t> face_axes;                 // the least polygon of each set of parallel ones
  std::vector<std::array<std::uint32_t, 2>> edge_axes;  // one true edge of each set of parallel ones

  [[nodiscard]] bool flat() const { return polygons.size() == 1; }
};

// The surface, or why it isn't one ("concave", "open surface", ..). The decision is exact for the binary32 vertices as
// parsed: a floating-point filter with a proven bound, then integers. A mesh without polygons is not asked about.
[[nodiscard]] std::expected<ConvexSurface, std::string> convex_surface(const Mesh& mesh);

// Two pieces with 256 polygons each have up to 384 x 384 pairs of edges, and each is a separating-axis candidate that
// reads up to 512 vertices: some 50 ms, already more than a tick. Above this, a hierarchy has to do it.
inline constexpr std::size_t kMaxPiecePolygons = 256;
// A convex polyhedron of 256 faces has at most 2 * 256 - 4 corners (Euler); a flat polygon is held to the same.
inline constexpr std::size_t kMaxPieceVertices = 2 * kMaxPiecePolygons;

}  // namespace peerd::collision
