#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// How what is displayed gets back to the ghost after news has moved that.
enum class ConvergenceMethod : std::uint8_t {
  kJump,      // at once
  kLinear,    // straight to where the ghost will be
  kCubic,     // projective velocity blending (C. Murphy, "Believable Dead Reckoning for Networked Games", 2011)
  kParabola,  // the seed's and Singhal and Cheriton's: it leaves as it went, and meets the ghost in the future
};

struct ConvergencePolicy {
  ConvergenceMethod method = ConvergenceMethod::kJump;
  Duration over = std::chrono::milliseconds(200);
};

// What a viewer draws of one object that another peer runs. A matter of display alone: nothing else ever sees it, and
// two peers may show different things of one ghost.
class Convergence {
 public:
  explicit Convergence(const ConvergencePolicy& policy) : policy_(policy) {}

  // Whether the object may be drawn on its straight way from one place to the other.
  using MayPass = std::function<bool(const Vec3& from, const Vec3& to)>;

  // At t, which never goes back. `revision`: of the ghost's future; when that is another one than at the last call, the
  // way back begins where the object was drawn then. Where it may not pass it jumps.
  [[nodiscard]] Pose shown(SimTime t, const KinematicState& ghost, std::uint64_t revision, const MayPass& may_pass);

  [[nodiscard]] std::uint64_t blocked() const { return blocked_; }  // ways that ended in a jump

 private:
  struct Drawn {
    SimTime at;
    Pose pose;
    Vec3 velocity;  // [m/s], world
  };
  [[nodiscard]] Drawn blended(SimTime t, const KinematicState& ghost) const;

  ConvergencePolicy policy_;
  std::optional<std::uint64_t> revision_;
  std::optional<Drawn> last_;
  std::optional<Drawn> from_;  // where the way back began; none: on the ghost
  std::uint64_t blocked_ = 0;
};

}  // namespace peerd::replication
