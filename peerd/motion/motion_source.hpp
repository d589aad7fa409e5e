#pragma once
#include <span>
#include <variant>
#include <vector>

#include "peerd/motion/motion_path.hpp"
#include "peerd/motion/motion_settings.hpp"

namespace peerd::config {

// What moves one object: formulas or a path. Velocity, acceleration and spin of a sample are right-hand derivatives.
class MotionSource {
 public:
  explicit MotionSource(FormulaMotion formula) : motion_(std::move(formula)) {}
  // With `hold`, stands at the pose of t = 0 before that.
  MotionSource(MotionPath path, bool hold) : motion_(std::move(path)), hold_(hold) {}

  [[nodiscard]] Pose pose(double t_s) const;
  [[nodiscard]] KinematicState sample(double t_s) const;

 private:
  std::variant<FormulaMotion, MotionPath> motion_;
  bool hold_ = false;
};

// What moves those that `numbers` names of all that share the motion; `places` are theirs in the world's file. `what`
// begins its errors.
[[nodiscard]] Result<std::vector<MotionSource>> make_sources(const MotionSettings& motion, const std::string& what,
                                                             std::span<const Pose> places,
                                                             std::span<const std::size_t> numbers,
                                                             std::uint64_t scenario_seed, double duration_s);

}  // namespace peerd::config
