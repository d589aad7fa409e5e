#pragma once
#include <cstdint>
#include <expected>
#include <span>
#include <vector>

#include "core/math.hpp"

namespace peerd {

// Velocities, or accelerations, of bodies under one-sided constraints: what touches does not approach.
struct ConstrainedBody {
  Vec3 value;               // [m/s] or [m/s^2], world frame
  double inverse_mass = 0;  // [1/kg], >= 0; 0: it gives way to nothing
};
// normal . (value of `a` - value of `b`) >= least, or == least where the two are held together. The indices are into
// the bodies and differ; the normal is a unit vector.
struct OneSided {
  std::uint32_t a, b;
  Vec3 normal;
  double least = 0.0;  // <= 0, so that bodies that do not move satisfy it
  bool is_held = false;
};

// A solution leaves approaches of at most this part of the largest value: rounding.
inline constexpr double kSolverRounding = 0x1p-38;

// Changes the values by as little as the constraints ask: by the least sum of mass * change^2. For accelerations this
// is Gauss's principle of least constraint; for velocities it is Moreau's inelastic impact, which never raises the
// kinetic energy as seen from the bodies that do not give way (J. J. Moreau, "Unilateral contact and dry friction in
// finite freedom dynamics", 1988). The method is the dual one of Goldfarb and Idnani ("A numerically stable dual
// method for solving strictly convex quadratic programs", 1983): it ends, as the sum of each of its sets is greater
// than that of the one before. A component below the rounding of the values that went in becomes zero, so that what
// rests has no speed at all.
//
// Returns the multiplier of each constraint: the impulse [Ns], or the force [N], by which it pushes the two apart; < 0
// only where they are held together.
//
// The values are as they were where it fails.
enum class LeastChangeError : std::uint8_t {
  kNoRoom,    // no values satisfy all constraints: bodies that do not give way come together
  kRounding,  // rounding hides them: of random sets at masses of 1 to 10^5, one in a thousand of a dozen constraints,
              // and one in twenty of fifty to a hundred
};
[[nodiscard]] std::expected<std::vector<double>, LeastChangeError> change_least(std::span<ConstrainedBody> bodies,
                                                                                std::span<const OneSided> constraints);

}  // namespace peerd
