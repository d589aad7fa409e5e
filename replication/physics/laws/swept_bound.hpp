#pragma once
#include "collision/contact/body.hpp"
#include "core/kinematics.hpp"
#include "replication/physics/laws/composed_motion.hpp"
#include "replication/physics/laws/timeline.hpp"

namespace peerd::replication {

// For CollisionType::kBox: the world box of a body that lies in a sphere lies in the sphere that is this much larger
// (sqrt(3), rounded up).
inline constexpr double kBoxReach = 1.7320508075688774;

// However the body is turned, no point of it, nor of its box, is farther from its origin [m].
[[nodiscard]] double radius_about_origin_m(const collision::Body& body);

// A region that a body may be in: a box of the centres of a sphere around it, and the radius of the sphere.
struct SweptRegion {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double radius_m = 0.0;
};

// The region of a body that stands with its origin at this place [m], however it is turned. It holds all bounds of the
// body there.
[[nodiscard]] SweptRegion standing_region(const collision::Body& body, const Vec3& position);

// The region in which a body can be from some instant on, as long as the piece of its timeline and the time that
// searches look ahead last: the box of the centre of its bounding sphere, and the radius of the sphere. The region
// contains the path at constant acceleration, the tangents that a search may take in its place, and all that rounding
// can add.
struct SweptBound : SweptRegion {
  // The bound is of the piece in force at `s`, for s in [from, until).
  std::optional<SimTime> last_change, next_change;        // of the Timeline, at s
  bool still = false;                                     // the body neither moves nor turns nor is accelerated at s
  SimTime from = SimTime::max(), until = SimTime::min();  // the bound answers for the instants s in [from, until)

  [[nodiscard]] bool answers_for(SimTime s) const { return s >= from && s < until; }
};

// The bound for the instant s. The sweep begins at `begin` <= s or where the piece does, and ends at `end` > s or
// where the piece does.
[[nodiscard]] SweptBound swept_bound(const Timeline& timeline, const collision::Body& body, SimTime s, SimTime begin,
                                     SimTime end);

// The same for a piece of a composed motion that is in force at s, with room for its error.
[[nodiscard]] SweptBound swept_bound(const ComposedPiece& piece, const collision::Body& body, SimTime s, SimTime begin,
                                     SimTime end);
// The bound as one without a radius: it holds the world box of the body, however that turns.
[[nodiscard]] SweptBound as_box(const SweptBound& bound);
// The bound of two such bounds together.
[[nodiscard]] SweptBound merged(const SweptBound& a, const SweptBound& b);

// Whether the two are certainly apart all the while that both are in their regions, so that first_contact() would
// answer kSeparated. False where a number is NaN.
[[nodiscard]] bool apart(const SweptRegion& a, const SweptRegion& b, CollisionType type);

}  // namespace peerd::replication
