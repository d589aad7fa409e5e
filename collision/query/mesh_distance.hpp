#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

// How far apart two meshes are, as an interval: of A's vertices and B's, as `a_from_b` rounds those, in real numbers.
struct MeshDistance {
  double lower_m = 0.0;          // certainly no two points are nearer
  double upper_m = 0.0;          // certainly two points are no farther apart; 0 only where they touch (exact)
  PolygonPair pair{};            // of `upper_m`
  Vec3 on_a, on_b;               // points of those polygons that have it, A's frame, as rounded
  std::uint32_t iterations = 0;  // pairs of nodes and of triangles looked at
};

// Any of these ends a query. Meshes that touch have upper_m 0 whatever the options.
struct MeshDistanceOptions {
  // upper - lower at the end, besides the rounding of places, 2^-43 of the largest coordinate.
  double accuracy_m = 0.0;
  double relative_accuracy = 0.0;                                 // or this part of upper
  double stop_above_m = std::numeric_limits<double>::infinity();  // lower >= this: farther apart than anybody asks
  double stop_below_m = 0.0;                                      // upper <= this: nearer than anybody asks
  std::uint32_t max_iterations = 1u << 18;                        // then the interval is what is known
};

// Pairs of nodes, then of triangles, the nearest boxes first, until no pair is left that could be nearer than the
// nearest one that is known. Nodes are built as they are looked at, none where boxes of the whole meshes say enough.
//
// An object keeps its memory, never an answer. Not thread-safe.
class MeshDistanceQuery {
 public:
  [[nodiscard]] MeshDistance distance(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                      const MeshDistanceOptions& options = {});

 private:
  struct Open {  // a pair of which no two points are nearer than `lower`, on A's scale
    float lower = 0.0f;
    std::uint32_t a = 0, b = 0;  // places in the trees, or faces
    bool triangles = false;
    std::uint32_t number = 0;  // of all that were opened
  };
  struct Nearer {
    // Never by places: those depend on what was built before.
    bool operator()(const Open& x, const Open& y) const {
      return x.lower != y.lower ? x.lower > y.lower : x.number < y.number;
    }
  };
  struct Search;

  WideQuery overlap_;
  std::vector<Open> open_;  // a heap, the nearest on top
};

}  // namespace peerd::collision
