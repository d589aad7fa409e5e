#pragma once
#include <array>
#include <cstdint>

#include "core/math.hpp"

namespace peerd::collision {

// Finds when a point and a triangle, or two segments, whose corners move along straight lines at constant speed, first
// meet. The method is inclusion-based, after Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, "A Large-scale
// Benchmark and an Inclusion-based Algorithm for Continuous Collision Detection", ACM Transactions on Graphics 40
// (2021): boxes of (time, two coordinates on the primitives) are halved until the distance is certainly not 0 in them
// or they are small. No root is missed, since the image of a box is bounded by those of its corners, with room for all
// rounding.

// A corner that moves along a straight line from time 0 to time 1 [m].
struct MovingPoint {
  Vec3 at_0 = Vec3::Zero(), at_1 = Vec3::Zero();
};

enum class ImpactState : std::uint8_t {
  kSeparated,  // certainly no contact in [0, 1]
  kHit,        // they come within the tolerance of each other, or touch; certainly not before `time`
  kUnsure,     // the iterations ran out; certainly no contact before `time`
};

struct LinearImpact {
  ImpactState state = ImpactState::kSeparated;
  double time = 1.0;  // in [0, 1]; never later than the first contact
  std::uint32_t iterations = 0;
};

struct ImpactOptions {
  // A distance that is certainly below this along each axis is a hit [m]. A contact has no distance at its time, so a
  // pass that is closer than the tolerance may be taken for a contact.
  double tolerance_m = 1e-6;
  std::uint32_t max_iterations = 1u << 18;
};

// The coordinates are finite. The triangle may have no area, and a segment no length.
[[nodiscard]] LinearImpact vertex_face_impact(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                              const ImpactOptions& options = {});
[[nodiscard]] LinearImpact edge_edge_impact(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                                            const ImpactOptions& options = {});

}  // namespace peerd::collision
