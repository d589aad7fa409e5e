#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/kinematics.hpp"
#include "peerd/config/toml_input.hpp"

namespace peerd::config {

// Motion by formula in t [s] since the scenario's start (t < 0 before it), in muParser's syntax plus `pi`, floor(x) and
// mod(x, y) (with the sign of y).
//
// It stands for whatever moves an object in earnest (a hand, a vehicle model, a motion capture): it hands out samples,
// and replication never sees the formula. Velocity and acceleration are right-hand derivatives, so at a corner they are
// those of what follows.
struct MotionFormula {
  std::vector<std::string> define;        // "name = expression", in order; later ones and the rest may use them
  std::string x = "0", y = "0", z = "0";  // position, world frame [m]
  std::vector<double> axis{0, 1, 0};      // of the rotation, world frame
  std::string angle = "0";                // about axis [rad]
  bool hold_before_start = false;         // stand at the pose of t = 0 until then, instead of being under way
};

// Reads the table [peer.NAME.motion.OBJECT].
[[nodiscard]] MotionFormula read_motion_formula(TomlReader& reader);

class MotionSource {
 public:
  // Errors: a formula that doesn't parse, or isn't finite at the times tried (-2 s to 0 and the duration's ends).
  [[nodiscard]] static Result<MotionSource> make(const MotionFormula& formula, const std::string& what,
                                                 double duration_s);
  MotionSource(MotionSource&&) noexcept;
  MotionSource& operator=(MotionSource&&) noexcept;
  ~MotionSource();

  [[nodiscard]] Pose pose(double t_s) const;
  [[nodiscard]] KinematicState sample(double t_s) const;

 private:
  struct Formulas;
  explicit MotionSource(std::unique_ptr<Formulas> formulas);
  std::unique_ptr<Formulas> formulas_;
};

}  // namespace peerd::config
