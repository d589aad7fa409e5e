#pragma once
#include <cstdint>
#include <vector>

#include "collision/wide_query.hpp"
#include "collision/wide_tree.hpp"

namespace peerd::collision {

// A body over a step: its frame's origin moves at a constant velocity, and it turns about that at a constant rate.
struct RigidMotion {
  Pose at_start;
  Vec3 velocity = Vec3::Zero();          // [m/s], world
  Vec3 angular_velocity = Vec3::Zero();  // [rad/s], world

  [[nodiscard]] Pose at(double t_s) const;
};

enum class MeshImpactState : std::uint8_t {
  kSeparated,   // certainly no contact within the step
  kHit,         // nearer than the tolerance at `time_s`, and no contact before
  kOverlapped,  // they touch at the start: exact
  kFailed,  // no contact before `time_s`, nothing is known of later: the iterations ran out, or, with time_s 0 and no
            // iterations, a soup is larger than 2^60 m
};

struct MeshImpact {
  MeshImpactState state = MeshImpactState::kSeparated;
  double time_s = 0.0;           // never later than the first contact; the step's length where there is none
  PolygonPair pair{};            // of kHit and kOverlapped
  double distance_m = 0.0;       // of that pair's triangles at time_s; 0 where they touch
  std::uint32_t iterations = 0;  // pairs of nodes and of triangles looked at
};

struct MeshImpactOptions {
  // A pair nearer than this is a hit [m]: the time is early by at most tolerance / (speed at which they approach), and
  // what passes more closely is taken for a contact. More than the rounding of a place in the world, 2^-46 of its
  // largest coordinate, or else that counts.
  double tolerance_m = 1e-6;
  std::uint32_t most_iterations = 1u << 18;
};

// When two meshes first touch. Conservative advancement (Mirtich, PhD, Berkeley 1996) of each pair of nodes by itself:
// boxes with a gap along a direction can't touch before the gap has been closed at the speed along it, plus what
// turning adds at most; so each pair of children has a time from which on it matters, and the earliest is looked at
// first. What is nearest in time and touches is the answer, whatever the step: a fast thin object does not tunnel.
//
// An object keeps its memory. Not thread-safe.
class MeshImpactQuery {
 public:
  [[nodiscard]] MeshImpact first_impact(WideTree& a, const RigidMotion& motion_a, WideTree& b,
                                        const RigidMotion& motion_b, double step_s,
                                        const MeshImpactOptions& options = {});

 private:
  struct Open {  // a pair that can't touch before `time_s`
    double time_s = 0.0;
    std::uint32_t a = 0, b = 0;  // places in the trees, or faces
    bool triangles = false;
  };
  struct Step;

  WideQuery overlap_;
  std::vector<Open> open_;  // a heap, the earliest on top
};

}  // namespace peerd::collision
