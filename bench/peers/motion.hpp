#pragma once
#include <cstddef>
#include <vector>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

struct Query {
  std::size_t a, b;   // bodies whose bounding spheres and boxes overlap
  std::size_t pairs;  // of triangles that touch, in truth
};
struct Frame {
  std::vector<Placement> bodies;
  std::vector<Query> queries;
};

inline constexpr std::size_t kBodies = 10;

// Ten bodies of one mesh that drift and spin in a crowd, pulled to its middle and pushed apart where they touch, so
// that most queries are close ones, and the others shallow contacts.
[[nodiscard]] std::vector<Frame> make_motion(const TriangleMesh& mesh, int frames, unsigned seed);

}  // namespace peerd::bench::peers
