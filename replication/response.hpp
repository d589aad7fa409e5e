#pragma once
#include "core/kinematics.hpp"
#include "core/scene.hpp"

namespace peerd::replication {

// How a Transform answers a contact (seed, appendix C.2). `n` is the unit normal of the other object's polygon in the
// world frame, facing this object; both states are those at the contact time, before anybody answered.
//
// INVERSE mirrors the velocity about the polygon. If the other answers as well, each mirrors its own, as in the seed;
// an object whose own velocity does not lead into the other keeps it, so the two always part and neither gains speed.
// If the other does not answer, the velocity is mirrored as seen from it: the seed's bare mirror would let a moving
// wall run through an object that stands. The acceleration stays in either case: it is the law of motion that the
// sender named (gravity, a curve being driven), not part of the bounce. Mirroring or dropping it raised the mean ghost
// error of the seed's scenario by up to two thirds and its updates from 7 to 13 (an independent model; second order,
// prediction, 500 ms). ZERO stops the object: velocity, acceleration and spin.
[[nodiscard]] KinematicState respond(ResponseType type, const KinematicState& self, const KinematicState& other,
                                     bool other_answers, const Vec3& n);

// Takes the approaching part out of velocity and acceleration, so that an object that bounces ever lower comes to rest
// against the other and goes on sliding.
[[nodiscard]] KinematicState rest_against(const KinematicState& self, const KinematicState& other, const Vec3& n);

}  // namespace peerd::replication
