#pragma once
#include <array>
#include <cstdint>

#include "core/math.hpp"

namespace peerd::collision {

// When a point and a triangle, or two segments, whose corners move along straight lines at constant speed, first meet.
// Inclusion-based, after Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, "A Large-scale Benchmark and an
// Inclusion-based Algorithm for Continuous Collision Detection", ACM Transactions on Graphics 40 (2021): boxes of
// (time, two coordinates on the primitives) are halved until the distance is certainly not 0 in them or they are small.
// No root is missed, since the image of a box is bounded by those of its corners, with room for all rounding.

// A corner from time 0 to time 1 [m].
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
  // Where the distance along each axis is certainly below it, that is a hit [m]. Contacts have no such distance at
  // their time; what passes each other more closely may be taken for one.
  double tolerance_m = 1e-6;
  std::uint32_t max_iterations = 1u << 18;
};

// Finite coordinates. The triangle, or a segment, may have no area or length.
[[nodiscard]] LinearImpact vertex_face_impact(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                              const ImpactOptions& options = {});
[[nodiscard]] LinearImpact edge_edge_impact(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                                            const ImpactOptions& options = {});

}  // namespace peerd::collision
