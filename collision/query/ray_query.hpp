#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "collision/exact/ray_triangle.hpp"
#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

struct RayHit {
  std::uint32_t polygon = 0;
  std::uint32_t face = 0;  // a face of the soup, one of the polygon's triangles
  double t = 0.0;          // the ray's parameter, as first_parameter() rounds it
  Vec3 point =
      Vec3::Zero();  // origin + t * direction, in binary64: off by 2^-51 (|origin| + t |direction|) along an axis
};

struct RayCounters {
  std::uint64_t bv_tests = 0;        // tests of a ray with a box
  std::uint64_t triangle_tests = 0;  // exact tests of a ray with a triangle
  OrientationCounters orientation;   // the work of the triangle tests
};

// Finds what a ray hits first: of all triangles of the soup with a first_parameter() of at most the ray's longest, the
// one with the least parameter; of those with an equal one that of the lowest polygon, then face. So the answer is a
// function of the soup and the ray alone: no order of the tree, no vector width and no rounding of the culling is in
// it. Both sides of a polygon are hit.
//
// An object keeps its memory, so that a query like one before allocates nothing. Not thread-safe.
class RayQuery {
 public:
  // The ray is usable, and in the soup's frame. The tree is built where the ray goes.
  [[nodiscard]] std::optional<RayHit> nearest(WideTree& tree, const Ray& ray);

  [[nodiscard]] const RayCounters& counters() const { return counters_; }

 private:
  struct Visit {
    WideTree::ChildSlot place;
    WideTree::Ref ref;  // what was there, which may be pending
    float entry;        // no later than where the ray enters its box
  };
  std::vector<Visit> stack_;
  RayCounters counters_;
};

}  // namespace peerd::collision
