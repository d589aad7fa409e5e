#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/kinematics.hpp"
#include "peerd/input/toml_input.hpp"

namespace peerd::config {

// Motion by formula in t [s] since the scenario's start (t < 0 before it) and n, the object's number among those that
// share the formula, in muParser's syntax plus `pi`, floor(x) and mod(x, y) (with the sign of y).
//
// position = (x, y, z) + R(axis, angle) offset, orientation = R(axis, angle) R(spin_axis, spin_angle).
struct MotionFormula {
  std::vector<std::string> define;         // "name = expression", in order; later ones and the rest may use them
  std::string x = "0", y = "0", z = "0";   // world frame [m]: of the origin, or of what it turns about
  std::vector<double> axis{0, 1, 0};       // of the rotation, world frame
  std::string angle = "0";                 // about axis [rad]
  std::vector<double> offset{0, 0, 0};     // of the origin from x, y, z before it turns [m]
  std::vector<double> spin_axis{0, 1, 0};  // of a rotation before that, so in the body's frame
  std::string spin_angle = "0";            // about spin_axis [rad]
  bool hold_before_start = false;          // stand at the pose of t = 0 until then, instead of being under way
};

// Reads the keys of a motion by formula.
[[nodiscard]] MotionFormula read_motion_formula(TomlReader& reader);

// Velocity and acceleration are right-hand derivatives, so at a corner they are those of what follows.
class FormulaMotion {
 public:
  // Errors: a formula that doesn't parse, or isn't finite at the times tried (-2 s to 0 and the duration's ends).
  [[nodiscard]] static Result<FormulaMotion> make(const MotionFormula& formula, const std::string& what,
                                                  double duration_s, std::size_t number = 0);
  FormulaMotion(FormulaMotion&&) noexcept;
  FormulaMotion& operator=(FormulaMotion&&) noexcept;
  ~FormulaMotion();

  [[nodiscard]] Pose pose(double t_s) const;
  [[nodiscard]] KinematicState sample(double t_s) const;

 private:
  struct Formulas;
  explicit FormulaMotion(std::unique_ptr<Formulas> formulas);
  std::unique_ptr<Formulas> formulas_;
};

}  // namespace peerd::config
