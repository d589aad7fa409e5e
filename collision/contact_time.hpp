#pragma once
#include <cstdint>

#include "collision/body.hpp"
#include "core/kinematics.hpp"

namespace peerd::collision {

enum class ContactState : std::uint8_t {
  kSeparated,    // no contact in [0, horizon]
  kContact,      // first contact at time_s
  kOverlapped,   // the closed sets already share a point at 0 (and do not just touch while approaching)
  kUnsupported,  // a body has no exact answer yet (Body::unsupported says which Shape and why)
  kFailed,       // the iteration cap was reached before the tolerance: neither contact nor its absence is known
};

struct Contact {
  ContactState state = ContactState::kSeparated;
  double time_s = 0.0;               // in [0, horizon], seconds after both base states
  Vec3 normal_world = Vec3::Zero();  // unit normal of the collidee's polygon, facing the collider
  ObjectId collidee_shape;           // which polygon the normal is of
  std::uint32_t collidee_polygon = 0;
  std::uint32_t iterations = 0;      // of conservative advancement; 0 where the closed form answered
};

// A body and how it moves from time 0 on.
struct MovingBody {
  const Body& body;
  const KinematicState& motion;
};

// When two moving bodies first come to touch while approaching each other, within [0, horizon_s].
//
// Bodies that touch or overlap at 0 and move apart are not in contact: they were answered before (a bounce begins so).
// Bodies that touch at 0 and approach are: time_s == 0. Bodies that overlap at 0 deeper than touching are kOverlapped,
// with normal_world the direction of least penetration.
//
// Without rotation the answer is in closed form for accelerations that are constant: on each separating-axis candidate
// the gap is a quadratic in t, and the bodies overlap where all gaps are <= 0. With rotation it is conservative
// advancement (Mirtich, PhD, Berkeley 1996) on the largest gap: never later than the truth, at most
// kAdvancementTolerance_m short of it.
//
// CollisionType::kBox uses the tight world boxes of all vertices in place of the polygons.
[[nodiscard]] Contact first_contact(const MovingBody& collider, const MovingBody& collidee, CollisionType type,
                                    double horizon_s);

inline constexpr double kAdvancementTolerance_m = 1e-6;
inline constexpr std::uint32_t kAdvancementCap = 512;

}  // namespace peerd::collision
