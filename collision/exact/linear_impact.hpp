#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/math.hpp"

namespace peerd::collision {

// Finds when a point and a triangle, or two segments, whose corners move along straight lines at constant speed, first
// meet. The method is inclusion-based, after Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, "A Large-scale
// Benchmark and an Inclusion-based Algorithm for Continuous Collision Detection", ACM Transactions on Graphics 40
// (2021): boxes of (time, two coordinates on the primitives) are halved, and cut to the part of their time in which the
// distance may be 0, until none is left or two points are near at the first time of one. No root is missed, since the
// image of a box is bounded by those of its corners, with room for all rounding.

// A corner that moves along a straight line from time 0 to time 1 [m].
struct MovingPoint {
  Vec3 at_0 = Vec3::Zero(), at_1 = Vec3::Zero();
};

enum class ImpactState : std::uint8_t {
  kSeparated,  // certainly no contact in the times asked for
  kHit,        // they come within margin and tolerance of each other, or touch; certainly not before `time`
  kUnsure,     // the iterations ran out; certainly no contact before `time`
};

struct LinearImpact {
  ImpactState state = ImpactState::kSeparated;
  double time = 1.0;  // in [0, 1]; never later than the first contact
  std::uint32_t iterations = 0;
};

struct ImpactOptions {
  // A distance that is certainly below this and the margin along each axis is a hit [m]; where rounding leaves more
  // room than this, one below that. A contact has no distance at its time, so a pass that is closer than the tolerance
  // may be taken for a contact.
  double tolerance_m = 1e-6;
  std::uint32_t max_iterations = 1u << 18;
  // A contact is a distance of at most this along each axis [m], >= 0: what is as near as that in space certainly is.
  double margin_m = 0.0;
  // The times in which contacts are sought, in [0, 1]: none before `begin` is known of, and one that is certainly later
  // than `last` counts as none. How times are halved depends on `begin` alone, so a hit has the same time for every
  // `last` that isn't before it.
  double begin = 0.0, last = 1.0;
};

namespace detail {

struct Interval {
  double lo = 0.0, hi = 1.0;
  [[nodiscard]] double width() const { return hi - lo; }
};

// The sides of the box are time and the two coordinates on the primitives.
struct ParameterBox {
  std::array<Interval, 3> side;
};

}  // namespace detail

// The coordinates are finite. The triangle may have no area, and a segment no length. The rounding that is allowed for
// is 2^-46 of the largest coordinate, so corners are best given from an origin that is near them.
//
// An object keeps its memory, so that a query like one before allocates nothing.
class LinearImpactQuery {
 public:
  [[nodiscard]] LinearImpact vertex_face(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                         const ImpactOptions& options = {});
  [[nodiscard]] LinearImpact edge_edge(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                                       const ImpactOptions& options = {});

 private:
  std::vector<detail::ParameterBox> open_;
};

// The same with memory of their own.
[[nodiscard]] LinearImpact vertex_face_impact(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face,
                                              const ImpactOptions& options = {});
[[nodiscard]] LinearImpact edge_edge_impact(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b,
                                            const ImpactOptions& options = {});

}  // namespace peerd::collision
