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

  // Whether the object may be drawn on its straight way from one place, where it was drawn last, to the other.
  using MayPass = std::function<bool(const Vec3& from, const Vec3& to)>;
  // Where the ghost was at an earlier time, by what is believed now; none where that is not known.
  using GhostPoseAt = std::function<std::optional<Pose>(SimTime)>;

  // At t, which never goes back. `revision`: of the ghost's future; when that is another one than at the last call, the
  // way back begins where the object was drawn then. Where something is in the way the object follows the ghost's own
  // way instead, from an earlier time on and faster: the ghost has got past what it may collide with. It jumps where no
  // place on that can be reached, or where the ghost itself has jumped.
  [[nodiscard]] Pose shown(SimTime t, const KinematicState& ghost, std::uint64_t revision, const MayPass& may_pass,
                           const GhostPoseAt& was = {});

  [[nodiscard]] std::optional<SimTime> last_shown() const { return last_ ? std::optional(last_->at) : std::nullopt; }
  [[nodiscard]] std::uint64_t blocked() const { return blocked_; }  // ways that ended in a jump
  [[nodiscard]] std::uint64_t detours() const { return detours_; }  // ways that followed the ghost's instead

 private:
  struct Drawn {
    SimTime at;
    Pose pose;
    Vec3 velocity;  // [m/s], world
  };
  // Behind the ghost on its own way.
  struct Trail {
    SimTime at;        // the ghost's time that is shown
    SimTime moved_at;  // when that last went on
  };
  [[nodiscard]] Drawn blended(SimTime t, const KinematicState& ghost) const;
  [[nodiscard]] std::optional<SimTime> reachable(SimTime t, const MayPass& may_pass, const GhostPoseAt& was) const;
  [[nodiscard]] std::optional<Drawn> trailing(SimTime t, const MayPass& may_pass, const GhostPoseAt& was);

  ConvergencePolicy policy_;
  std::optional<std::uint64_t> revision_;
  std::optional<Drawn> last_;
  std::optional<Drawn> from_;  // where the way back began; none: on the ghost
  std::optional<Trail> trail_;
  std::uint64_t blocked_ = 0, detours_ = 0;
};

}  // namespace peerd::replication
