#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

// The distance of two meshes as an interval: that of A's vertices and B's, as `a_from_b` rounds those, in real numbers.
struct MeshDistance {
  double lower_m = 0.0;          // certainly no two points are nearer
  double upper_m = 0.0;          // certainly two points are no farther apart; 0 only where they touch (exact)
  PolygonPair pair{};            // the polygons of `upper_m`
  Vec3 on_a, on_b;               // points of those polygons at that distance, A's frame, rounded [m]
  std::uint32_t iterations = 0;  // pairs of nodes and of triangles visited
};

// Any of these ends a query. Meshes that touch have upper_m 0 whatever the options.
struct MeshDistanceOptions {
  // The largest upper - lower at the end [m], besides the rounding of places, 2^-43 of the largest coordinate.
  double accuracy_m = 0.0;
  double relative_accuracy = 0.0;                                 // or this part of upper_m
  double stop_above_m = std::numeric_limits<double>::infinity();  // ends the query where lower >= this
  double stop_below_m = 0.0;                                      // ends the query where upper <= this
  std::uint32_t max_iterations = 1u << 18;                        // then the interval is what is known
};

// Visits pairs of nodes, then of triangles, the nearest boxes first, until no pair is left that could be nearer than
// the nearest one that is known. Nodes are built as they are visited, none where boxes of the whole meshes say enough.
//
// An object keeps its memory, never an answer. Not thread-safe.
class MeshDistanceQuery {
 public:
  [[nodiscard]] MeshDistance distance(WideTree& a, WideTree& b, const RelativeMotion& a_from_b,
                                      const MeshDistanceOptions& options = {});

 private:
  struct Open {  // a pair of which no two points are nearer than `lower`, on A's scale
    float lower = 0.0f;
    std::uint32_t a = 0, b = 0;  // slots in the trees, or faces
    bool triangles = false;
    std::uint32_t number = 0;  // counts the pairs that were opened
  };
  struct Nearer {
    // Ties are not broken by slots: those depend on what was built before.
    bool operator()(const Open& x, const Open& y) const {
      return x.lower != y.lower ? x.lower > y.lower : x.number < y.number;
    }
  };
  struct Search;

  WideQuery overlap_;
  std::vector<Open> open_;  // a heap, the nearest on top
};

}  // namespace peerd::collision
