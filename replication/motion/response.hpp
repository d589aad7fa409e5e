#pragma once
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "replication/motion/motion_model.hpp"

namespace peerd::replication {

// One side of a contact: an object and what it meets. `n` is the unit normal of the contact in the world frame, facing
// this object: of the polygon of the other, or, where both are a Sphere each (collision::Body::sphere), along the line
// of their centres. States are those at the contact time, before any response.
struct ContactSide {
  const CollisionResponse& response;        // of this object
  const CollisionResponse* other_response;  // null: the other has none
  bool other_responds;                      // false: the other goes on as before, whatever its response says
  const KinematicState &self, &other;
  Vec3 n;
};

// The response of a Transform to a contact (Ohlenburg 2003, appendix C.2).
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
// two approach, so that they part with e u and their momentum stays. An object that does not respond by impulse as
// well (a wall, a driven racket) has infinite mass, and its velocity counts: a racket that comes adds speed. The e of
// a pair is the smaller of the two (PhysX's PxCombineMode::eMIN; other engines take the product or the larger: the
// smaller keeps a dead cushion dead and needs no table of pairs); an object without a response of this type sets none.
// There is no friction at the contact, so neither spin changes.
[[nodiscard]] KinematicState respond(const ContactSide& side);

// Takes the approaching part out of velocity and acceleration, so that an object that bounces ever lower comes to rest
// against the other and goes on sliding. Of two objects that respond by impulse each takes its share by mass: e = 0.
// `pressed`: they part too slowly to come apart (collision::Contact::resting), and the remaining speed is taken out,
// too: without the acceleration it would lift the object off for good.
[[nodiscard]] KinematicState come_to_rest_against(const ContactSide& side, bool pressed = false);

// The law by which an object of that response goes on. With `friction` it slides to rest where nothing else
// accelerates it: an object that flies under gravity keeps gravity until it lies on what it fell on. `law` is the one
// that it was under, `after` its state now, for a new velocity by a key as well as for a response by IMPULSE.
[[nodiscard]] MotionModel law_after(const CollisionResponse* response, const MotionModel& law,
                                    const KinematicState& after);

// The law of an object after a decision, which carries states and no laws: an acceleration that is exactly that of
// friction means that the object slides.
[[nodiscard]] MotionModel law_of_outcome(const CollisionResponse* response, const KinematicState& after);

}  // namespace peerd::replication
