#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "core/kinematics.hpp"
#include "core/time.hpp"

namespace peerd::replication {

// The way in which the displayed object returns to its ghost after an update has moved the ghost.
enum class ConvergenceMethod : std::uint8_t {
  kJump,      // at once
  kLinear,    // in a straight line to where the ghost will be
  kCubic,     // projective velocity blending (C. Murphy, "Believable Dead Reckoning for Networked Games", 2011)
  kParabola,  // Ohlenburg 2003, after Singhal and Cheriton: leaves with its velocity, meets the ghost in the future
  kAdaptive,  // Singhal and Cheriton 1995: straight where the last three updates nearly lie on a line, else kParabola,
              // within the time between the last two of them
};

struct ConvergencePolicy {
  ConvergenceMethod method = ConvergenceMethod::kJump;
  Duration over = std::chrono::milliseconds(200);
};

// The pose in which a viewer draws one remote object. It is a matter of display alone: nothing else depends on it, and
// two peers may display one ghost differently.
class Convergence {
 public:
  explicit Convergence(const ConvergencePolicy& policy) : policy_(policy), way_(policy) {}

  // Whether the object may be drawn on its straight way from one place, where it was drawn last, to the other.
  using MayPass = std::function<bool(const Vec3& from, const Vec3& to)>;
  // The pose of the ghost at an earlier time, by what is known now; none where that is not known.
  using GhostPoseAt = std::function<std::optional<Pose>(SimTime)>;

  // The pose at t, which never goes back. `revision`: of the ghost's future; when it differs from the last call, the
  // way back begins where the object was drawn then. Where something is in the way, the object follows the ghost's own
  // way instead, from an earlier time on and faster: the ghost has got past what it may collide with. The object jumps
  // where no place on that way can be reached, or where the ghost itself has jumped.
  [[nodiscard]] Pose shown(SimTime t, const KinematicState& ghost, std::uint64_t revision, const MayPass& may_pass,
                           const GhostPoseAt& was = {});

  [[nodiscard]] std::optional<SimTime> last_shown() const { return last_ ? std::optional(last_->at) : std::nullopt; }
  [[nodiscard]] std::uint64_t blocked() const { return blocked_; }  // the number of ways that ended in a jump
  [[nodiscard]] std::uint64_t detours() const {
    return detours_;
  }  // the number of ways that followed the ghost's instead

 private:
  struct Drawn {
    SimTime at;
    Pose pose;
    Vec3 velocity;  // [m/s], world
  };
  // The object is drawn behind the ghost, on the way that the ghost took.
  struct Trail {
    SimTime at;        // the time of the ghost at which it is drawn
    SimTime moved_at;  // when `at` last advanced
  };
  [[nodiscard]] Drawn blended(SimTime t, const KinematicState& ghost) const;
  [[nodiscard]] std::optional<SimTime> reachable(SimTime t, const MayPass& may_pass, const GhostPoseAt& was) const;
  [[nodiscard]] std::optional<Drawn> trailing(SimTime t, const MayPass& may_pass, const GhostPoseAt& was);

  // Chooses the next way back by where the ghost is at its last three changes.
  void adapt(SimTime t, const Vec3& ghost);

  ConvergencePolicy policy_;
  ConvergencePolicy way_;  // of the way back that is under way: policy_, or what adapt() has chosen
  struct Change {
    SimTime at;
    Vec3 position;
  };
  std::optional<Change> last_change_, change_before_;  // of the ghost
  std::optional<std::uint64_t> revision_;
  std::optional<Drawn> last_;
  std::optional<Drawn> from_;  // where the way back began; none: the object is drawn at the ghost
  std::optional<Trail> trail_;
  std::uint64_t blocked_ = 0, detours_ = 0;
};

}  // namespace peerd::replication
