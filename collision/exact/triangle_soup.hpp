#pragma once
#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "collision/exact/triangle.hpp"
#include "core/box.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd::collision {

// The triangles of a mesh's polygons, cut by core/geometry/triangulation.hpp's fixed rule, in the rigid frame of a
// Shape: exact queries work on these. Polygons that are cracked, doubled, crumpled or without an area are all kept.
struct TriangleSoup {
  struct Face {
    std::array<std::uint32_t, 3> corners;  // into `vertices`
    std::uint32_t polygon;                 // a polygon of the mesh, in file order
    friend bool operator==(const Face&, const Face&) = default;
  };
  std::vector<Vec3> vertices;  // [m], one for each of the mesh's
  std::vector<Face> faces;     // in the order of their polygons
  WorldBox box;                // the box of the vertices that faces use, in the soup's frame

  [[nodiscard]] Triangle triangle(std::uint32_t face) const {
    const auto& c = faces[face].corners;
    return {vertices[c[0]], vertices[c[1]], vertices[c[2]]};
  }
};

static_assert(sizeof(TriangleSoup::Face) == 16);  // hierarchy files hash faces as bytes

// The largest coordinate that is accepted [m]: no binary32 number is larger. Files do have the largest binary32
// numbers, for half spaces; only a scale leads beyond.
inline constexpr double kLargestCoordinate_m = 0x1p128;

// Whether each coordinate is a number within kLargestCoordinate_m.
[[nodiscard]] bool is_representable(const Vec3& vertex);

// `stretch` (core/transform.hpp, StretchedPose) is baked into the vertices: multiply(stretch, vertex) as binary64; the
// identity leaves them as they were parsed. The error names the vertex that is too far out or no number at all.
[[nodiscard]] std::expected<TriangleSoup, std::string> make_soup(const Mesh& mesh,
                                                                 const Mat3& stretch = Mat3::Identity());

}  // namespace peerd::collision
