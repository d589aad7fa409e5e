#pragma once
#include <cstdint>
#include <vector>

#include "collision/exact/triangle_soup.hpp"

namespace peerd::collision::engines {

// A part of a soup's surface that is treated as convex: each of its vertices is a vertex of the convex hull's graph, or
// the piece is one triangle. What is inside a closed piece does not touch it: only its faces do.
struct SoupPiece {
  std::vector<std::uint32_t> faces;                   // of the soup
  std::vector<std::uint32_t> vertices;                // of the soup, one for each position
  std::vector<std::vector<std::uint32_t>> neighbors;  // by place in `vertices`: the places along edges
};

// The pieces of a soup. A set of faces that are connected along edges is one piece where it is the whole boundary of a
// convex polyhedron: closed, wound one way round, and with all its vertices on or behind the plane of each face; the
// signs are exact. Of all other sets each face is a piece. I-COLLIDE leaves the partition of an object to its user.
[[nodiscard]] std::vector<SoupPiece> convex_pieces(const TriangleSoup& soup);

// A larger set is not examined, since that costs its faces times its vertices: its faces are pieces.
inline constexpr std::size_t kLargestConvexFaces = 4096;

}  // namespace peerd::collision::engines
