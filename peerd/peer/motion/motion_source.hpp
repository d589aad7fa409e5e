#pragma once
#include <span>
#include <variant>
#include <vector>

#include "peerd/peer/motion/motion_path.hpp"
#include "peerd/peer/motion/motion_settings.hpp"

namespace peerd::motion {

// The motion of one object, by formulas or by a path. Velocity, acceleration and spin of a sample are right-hand
// derivatives.
class MotionSource {
 public:
  explicit MotionSource(FormulaMotion formula) : motion_(std::move(formula)) {}
  // The object stands at the pose of t = 0 before that, if `hold` is set.
  MotionSource(MotionPath path, bool hold) : motion_(std::move(path)), hold_(hold) {}

  [[nodiscard]] Pose pose(double t_s) const;
  [[nodiscard]] KinematicState sample(double t_s) const;

 private:
  std::variant<FormulaMotion, MotionPath> motion_;
  bool hold_ = false;
};

// Makes the motions of the objects that `numbers` selects among all that share `motion`. `places` are the places of all
// of them in the world's file. Errors begin with `what`.
[[nodiscard]] Result<std::vector<MotionSource>> make_sources(const MotionSettings& motion, const std::string& what,
                                                             std::span<const Pose> places,
                                                             std::span<const std::size_t> numbers,
                                                             std::uint64_t scenario_seed, double duration_s);

}  // namespace peerd::motion
