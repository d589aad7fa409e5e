#pragma once
#include <algorithm>
#include <cstdint>

#include "collision/contact/body.hpp"
#include "core/kinematics.hpp"

namespace peerd::collision {

enum class ContactState : std::uint8_t {
  kSeparated,    // no contact in [0, horizon]
  kContact,      // first contact at time_s
  kOverlapped,   // the bodies share more than touching points at 0, whichever way they move
  kUnsupported,  // the two have no exact answer: see has_exact_answer()
  kFailed,       // the iteration cap was reached: certainly no contact before time_s, nothing is known of later
};

struct Contact {
  ContactState state = ContactState::kSeparated;
  double time_s = 0.0;               // in [0, horizon], seconds after both base states
  Vec3 normal_world = Vec3::Zero();  // unit normal of the collidee's polygon, facing the collider
  // The unit normal of the plane that lies between the two where they touch, facing the collider. It differs from
  // normal_world where the collidee meets the collider with a corner or an edge: its polygons there face elsewhere.
  Vec3 separating_normal_world = Vec3::Zero();
  bool resting = false;     // they touch at 0 with no speed towards each other, and only the acceleration
                            // presses: reflecting the velocity can't end this contact
  ObjectId collidee_shape;  // the Shape whose polygon the normal is of; for kBox the collidee itself, and polygon 0
  std::uint32_t collidee_polygon = 0;
  std::uint32_t iterations = 0;  // steps of conservative advancement; 0 where the closed form answered
};

// MeetAs says what a body counts as. As a surface or a solid a Sphere is round; as polygons it has facets. Bodies that
// cross overlap in any case.
enum class MeetAs : std::uint8_t {
  kSurfaces,  // a body that begins wholly inside another one is apart from it, and meets it from inside
  kSolids,    // a body that is inside a Sphere or a convex piece overlaps it
  kPolygons   // only polygons count, as SceneQuery has them
};

// A body and how it moves from time 0 on.
struct MovingBody {
  const Body& body;
  const KinematicState& motion;
};

// Times are passed on as SimTime, whole nanoseconds (core/time.hpp): at its rounded contact time, a body may already be
// this much of its motion inside. With a longer tick, a bounce of that length would be taken for rest.
inline constexpr double kClockTick_s = 1e-9;
// What advances conservatively is a contact when it is as near as this [m], or as near as this part of the smaller
// body's radius where that is less.
inline constexpr double kAdvancementTolerance_m = 1e-6;
inline constexpr double kAdvancementToleranceOfRadius = 0x1p-10;
[[nodiscard]] inline double advancement_tolerance_m(double radius_a_m, double radius_b_m) {
  return std::min(kAdvancementTolerance_m, kAdvancementToleranceOfRadius * std::min(radius_a_m, radius_b_m));
}
inline constexpr std::uint32_t kAdvancementCap = 512;

}  // namespace peerd::collision
