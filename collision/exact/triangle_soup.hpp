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

// What exact queries work on: the triangles of a mesh's polygons, cut by core/geometry/triangulation.hpp's fixed rule,
// in the rigid frame of a Shape. Whatever the polygons were, cracked, doubled, crumpled or without an area, is still
// there.
struct TriangleSoup {
  struct Face {
    std::array<std::uint32_t, 3> corners;  // into `vertices`
    std::uint32_t polygon;                 // of the mesh, in file order
    friend bool operator==(const Face&, const Face&) = default;
  };
  std::vector<Vec3> vertices;  // [m], one for each of the mesh's
  std::vector<Face> faces;     // by polygon
  WorldBox box;                // of the vertices that faces use, in the soup's frame

  [[nodiscard]] Triangle triangle(std::uint32_t face) const {
    const auto& c = faces[face].corners;
    return {vertices[c[0]], vertices[c[1]], vertices[c[2]]};
  }
};

// Coordinates beyond this [m] are refused: what no binary32 number can be. Files do have its largest numbers, for half
// spaces; only a scale leads beyond.
inline constexpr double kLargestCoordinate_m = 0x1p128;

// Each coordinate; not what is no number.
[[nodiscard]] bool is_representable(const Vec3& vertex);

// `stretch` (core/transform.hpp, StretchedPose) is baked into the vertices: multiply(stretch, vertex) as binary64; the
// identity leaves them as they were parsed. The error names the vertex that is too far out or no number at all.
[[nodiscard]] std::expected<TriangleSoup, std::string> make_soup(const Mesh& mesh,
                                                                 const Mat3& stretch = Mat3::Identity());

}  // namespace peerd::collision
