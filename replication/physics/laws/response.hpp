#pragma once
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "replication/physics/laws/motion_model.hpp"

namespace peerd::replication {

// The part of the other object in a contact.
enum class OtherSide : std::uint8_t {
  kGoesOn,        // as before: it answers no contacts, or something else moves it
  kAnswers,       // in this contact
  kAnswersApart,  // physics moves it, and it answers contacts, but not this one: in one of its own with another normal,
                  // or never
};

// One side of a contact: an object and what it meets. `n` is the unit normal of the contact in the world frame, facing
// this object (collision/contact/contact_time.hpp). States are those at the contact time, before any response.
struct ContactSide {
  const CollisionResponse& response;        // of this object
  const CollisionResponse* other_response;  // null: the other has none
  OtherSide other_side;
  const KinematicState &self, &other;
  Vec3 n;
};

// The response of a Transform to a contact (Ohlenburg 2003, appendix C.2). Two objects that respond to each other never
// hold more energy afterwards:
//
// | the two respond by  | momentum along n | kinetic energy                                  |
// |---------------------|------------------|-------------------------------------------------|
// | IMPULSE and IMPULSE | stays            | the part of their approach is kept to e^2       |
// | INVERSE and INVERSE | changes          | each keeps its own                              |
// | ZERO and any        | changes          | the one by ZERO loses its own                   |
// | IMPULSE and INVERSE | changes          | each alone: kept to e^2 along n, and kept       |
// | one of two alone    | changes          | as from a wall that stands, if the other answers elsewhere |
// | any and no response | changes          | as seen from the other, as above: one that comes adds |
//
// INVERSE mirrors the velocity about the polygon. If the other responds as well, each mirrors its own, as in the
// thesis; an object whose own velocity does not lead into the other keeps it, so the two always part and neither gains
// speed. If the other does not respond, the velocity is mirrored relative to it: the bare mirror of the thesis would
// let a moving wall run through an object that stands. The acceleration stays in either case: it is the law of motion
// that the sender named (gravity, a curve being driven), not part of the bounce. Mirroring or dropping it raised the
// mean ghost error of the thesis's scenario by up to two thirds and its updates from 7 to 13 (an independent model;
// second order, prediction, 500 ms). ZERO stops the object: velocity, acceleration and spin.
//
// IMPULSE is Newton's law of restitution: j = (1 + e) u / (1/m_a + 1/m_b) along n, where u is the speed at which the
// two approach, so that they part with e u and their momentum stays. An object that does not respond (a wall, a driven
// racket) has infinite mass, and its velocity counts: a racket that comes adds speed. One that responds otherwise is to
// the IMPULSE a wall that stands, for its own response turns its own velocity: if each took the other's velocity for a
// racket's, the two would drive each other up. The e of a pair is the smaller of the two (PhysX's
// PxCombineMode::eMIN; other engines take the product or the larger: the smaller keeps a dead cushion dead and needs no
// table of pairs); an object without a response of this type sets none. There is no friction at the contact, so neither
// spin changes here; a corner's strike and a rest end spin (motion_world.hpp).
[[nodiscard]] KinematicState respond(const ContactSide& side);

// Whether two objects that part along n with that speed [m/s] while the relative acceleration along n [m/s^2] draws
// them together meet again within kShortestFlight_s: they stay together, or they would bounce for ever. At 10 m/s^2
// such a bounce is a micrometre high.
inline constexpr double kShortestFlight_s = 0x1p-10;
[[nodiscard]] bool comes_to_rest(double parting_speed_m_s, double acceleration_m_s2,
                                 double shortest_flight_s = kShortestFlight_s);

// The law by which an object of that response goes on. With `friction` it slides to rest where nothing else
// accelerates it, or stands if that would take less than kShortestFlight_s: an object that flies under gravity keeps
// gravity until it lies on what it fell on. `law` is the one that it was under, `after` its state now, for a new
// velocity by a key as well as for a response by IMPULSE.
[[nodiscard]] MotionModel law_after(const CollisionResponse* response, const MotionModel& law,
                                    const KinematicState& after);

// The law of an object after a decision, which carries states and no laws: an acceleration that is exactly that of
// friction means that the object slides.
[[nodiscard]] MotionModel law_of_outcome(const CollisionResponse* response, const KinematicState& after);

}  // namespace peerd::replication
