#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/kinematics.hpp"
#include "peerd/input/toml_input.hpp"

namespace peerd::motion {

// Motion by formula in t [s] since the scenario's start (t < 0 before it) and n, the object's number among those that
// share the formula, in muParser's syntax plus `pi`, floor(x) and mod(x, y) (with the sign of y).
//
// position = (x, y, z) + R(axis, angle) offset, orientation = R(axis, angle) R(spin_axis, spin_angle).
struct MotionFormula {
  std::vector<std::string> define;         // "name = expression", in order; later ones and the rest may use them
  std::string x = "0", y = "0", z = "0";   // origin, or centre of the orbit, in the world [m]
  std::vector<double> axis{0, 1, 0};       // axis of the rotation, in the world
  std::string angle = "0";                 // angle about axis [rad]
  std::vector<double> offset{0, 0, 0};     // the origin's offset from x, y, z before the rotation [m]
  std::vector<double> spin_axis{0, 1, 0};  // axis of a rotation that comes first, in the body's frame
  std::string spin_angle = "0";            // angle about spin_axis [rad]
  bool hold_before_start = false;          // stand at the pose of t = 0 before the start
};

// Reads the keys of a motion by formula.
[[nodiscard]] MotionFormula read_motion_formula(TomlReader& reader);

// Velocity and acceleration are right-hand derivatives, so at a corner they are those of the motion after it.
class FormulaMotion {
 public:
  // Errors are a formula that does not parse, or one that is not finite at the times tried (-2 s to 0 and the
  // duration's ends).
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

}  // namespace peerd::motion
