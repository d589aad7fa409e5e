#pragma once
#include <optional>

#include "collision/exact/linear_impact.hpp"
#include "core/box.hpp"

namespace peerd::collision {

// A triangle whose corners move along straight lines, each at constant speed, from time 0 to time 1 [m]. At each
// instant it is the closed hull of its corners, which may have no area.
using MovingTriangle = std::array<MovingPoint, 3>;

struct MovingTriangleOptions {
  double margin_m = 0.0;      // >= 0: as near as this counts as a contact
  double tolerance_m = 1e-6;  // > 0: as near as margin and tolerance is a hit
  double last = 1.0;          // in [0, 1]: a contact that is certainly later counts as none
  // The steps of conservative advancement before the inclusion tests take over, and the iterations of each of those 15.
  // Most pairs take one step; edges that turn into each other as they meet take hundreds.
  std::uint32_t max_steps = 512;
  std::uint32_t max_iterations = 1u << 14;
};

// The box of all places that a moving triangle is in: exact, since its sides are coordinates of corners.
[[nodiscard]] WorldBox swept_box(const MovingTriangle& triangle);

// Whether two boxes may be as near as `margin_m` along each axis: false is certain, since a difference is rounded in
// order.
[[nodiscard]] inline bool boxes_near(const WorldBox& a, const WorldBox& b, double margin_m) {
  for (int k = 0; k < 3; ++k) {
    if (b.lo[k] - a.hi[k] > margin_m || a.lo[k] - b.hi[k] > margin_m) return false;
  }
  return true;
}

// A time before which the triangles are certainly farther apart than `margin_m`, by the boxes that they have at each
// instant; nothing where they are so from 0 to 1.
[[nodiscard]] std::optional<double> first_box_contact(const MovingTriangle& a, const MovingTriangle& b,
                                                      double margin_m = 0.0);

// Finds when two moving triangles first come as near as a margin.
//
// Along a fixed direction the gap of two corners is linear in time, so that the time at which the gap of two triangles
// is used up has a closed form. Conservative advancement (Mirtich, PhD, Berkeley 1996) goes from one such time to the
// next, along the best of the directions of nearest points, of faces and of pairs of edges; of bodies that don't turn
// it takes one step. Where it gets stuck, linear_impact.hpp goes on from there: six vertices against faces, and nine
// pairs of edges.
//
// kSeparated: certainly no point of A comes as near as the margin to one of B in [0, last], the ends included.
// kHit: none does before `time`, and there the triangles are as near as margin + e along each axis, where e is the
//   tolerance, or 2^-42 of the pair's swept size where that is larger (for triangles that move through kilometres).
//   Triangles that touch or cross at 0 are a hit at 0. What is between margin and margin + e may be a hit, but not
//   where it certainly stays apart to the end: what parts, or slides along, is separated where a direction shows it.
// kUnsure: none does before `time`.
//
// The first contact of triangles that are apart at 0 is one of a vertex and a face or of two edges: at that instant 0
// is on the border of the set of differences A - B (with a margin, the point of that set nearest to 0 is), so a plane
// separates the two; of the faces of A and B in that plane, which are corners, edges or triangles, an extreme point of
// the intersection is a corner of one or a crossing of two edges. Therefore the 15 tests miss no contact.
//
// The answer has the same bits if A and B change places. The coordinates are within kLargestCoordinate_m. An object
// keeps its memory; not thread-safe.
class MovingTriangleQuery {
 public:
  [[nodiscard]] LinearImpact first_impact(const MovingTriangle& a, const MovingTriangle& b,
                                          const MovingTriangleOptions& options = {});

 private:
  LinearImpactQuery inclusion_;
};

}  // namespace peerd::collision
