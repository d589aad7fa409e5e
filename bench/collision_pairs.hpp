#pragma once
#include <string>
#include <vector>

#include "collision/exact/triangle_pair.hpp"
#include "collision_meshes.hpp"

namespace peerd::bench {

struct TrianglePair {
  collision::Triangle a, b;
};
struct PairInput {
  std::string name;
  std::vector<TrianglePair> pairs;
};

// The moving pairs are those that reach the test of triangles in the scene of collision_motion.hpp.
[[nodiscard]] PairInput moving_pairs(const NamedSoup& object, bool quick);
// A box and a heap of triangles on a floor: as they are; turned; floor and object tilted alike; or so with rounded
// vertices, so that nothing is aligned with an axis and what was one plane is so but for rounding.
[[nodiscard]] std::vector<PairInput> resting_pairs(bool quick);
// One of each generator in tests/oracle/triangle_cases.hpp.
[[nodiscard]] std::vector<PairInput> adversarial_pairs(bool quick);

}  // namespace peerd::bench
