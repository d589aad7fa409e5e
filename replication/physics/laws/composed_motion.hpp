#pragma once
#include <optional>
#include <span>

#include "core/kinematics.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/timeline.hpp"

namespace peerd::replication {

// The motion of a node below carriers: a carrier's timeline is relative to the rigid frame of the carrier above it, and
// the composition of all of them is the motion in the frame of the first one.
//
//   frame ──first──> BUS ──> DOOR ──last──> HANDLE        p_frame = BUS(t) * DOOR(t) * HANDLE(t) * p_handle
//
// Nothing is accumulated: each state comes from the closed forms of the laws in force.

// The timelines from the top down to the node's own; at least one.
using Chain = std::span<const Timeline* const>;

// The state in the frame of `carrier` of what moves relative to it in that way; the derivatives are those of carriers
// whose spin is constant.
[[nodiscard]] KinematicState composed(const KinematicState& carrier, const KinematicState& relative);
// The inverse: composed(carrier, relative_to(carrier, state)) is `state`, but for rounding.
[[nodiscard]] KinematicState relative_to(const KinematicState& carrier, const KinematicState& state);

[[nodiscard]] KinematicState composed_at(Chain chain, SimTime t);

// The state at t by the laws that are in force at `law_at`, of which t may be the end.
[[nodiscard]] KinematicState composed_at(Chain chain, SimTime law_at, SimTime t);
// The instant until which the laws in force at t are smooth closed forms; none: for ever.
[[nodiscard]] std::optional<SimTime> smooth_until(Chain chain, SimTime t);
// Bounds, from t until h_s later, of the motion of a point in the frame of the chain, by those of its motion in the
// node's own frame. The laws in force at t are taken to go on.
[[nodiscard]] MotionBounds composed_bounds(Chain chain, SimTime t, double h_s, const MotionBounds& in_node);

// How far a piece of h_s [s] at constant acceleration and spin, that goes through the true poses at its ends and the
// true position in the middle, is off anywhere in between, for points within `extent_m` of the node's origin [m].
[[nodiscard]] double error_of_piece_m(const MotionBounds& bounds, double extent_m, double h_s);

// A part of a composed motion at constant acceleration and spin. It goes through the true pose at both ends and the
// true position in the middle.
struct ComposedPiece {
  SimTime begin;               // of `state`
  std::optional<SimTime> end;  // none: it lasts for ever
  KinematicState state;
  // No point within `extent_m` of the node's origin is farther than this from where it truly is [m]; 0: but for
  // rounding.
  double error_m = 0.0;
  bool still = false;  // nothing moves or turns within the piece
};

// The piece in force at t for points within `extent_m` [m] of the node's origin. Carriers that do not turn are composed
// exactly, into pieces as long as the laws in force. Any other motion is cut on a grid of session time, with steps of a
// power of two of nanoseconds between 2^16 and 2^27: the longest that keep the error below `error_max_m` [m], by bounds
// of the laws' derivatives: |jerk| h^3 / 124 and reach |alpha| h^2 / 7. Where even 2^16 ns do not, the error is what it
// is. The piece is a function of the laws, of t and of the two lengths alone.
[[nodiscard]] ComposedPiece composed_piece(Chain chain, SimTime t, double extent_m, double error_max_m);

}  // namespace peerd::replication
