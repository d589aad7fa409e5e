#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "collision/query/wide_query.hpp"
#include "collision/tree/wide_tree.hpp"
#include "core/kinematics.hpp"

namespace peerd::collision {

enum class MeshImpactState : std::uint8_t {
  kSeparated,       // certainly no contact within the step
  kHit,             // nearer than the tolerance at `time_s` and not parting, and no contact before
  kOverlapped,      // they touch at the start: exact
  kIterationLimit,  // failed: no contact before `time_s`, nothing is known of later; the iterations ran out
  kTooLarge,        // failed: no contact before `time_s`, nothing is known of later: a mesh is larger than 2^60 m, or
                    // they are 2^62 m apart then
};

struct MeshImpact {
  MeshImpactState state = MeshImpactState::kSeparated;
  double time_s = 0.0;  // never later than the first contact; the step's length where there is none
  PolygonPair pair{};   // the polygons of kHit and kOverlapped
  // The following are set for kHit only.
  double distance_m = 0.0;        // distance of that pair's triangles at time_s
  Vec3 direction = Vec3::Zero();  // from A's to B's, world, unit
  bool resting = false;           // they don't approach, but an acceleration presses, or one turns and may come nearer
  std::uint32_t iterations = 0;   // pairs of nodes, of leaves and of triangles visited
};

struct MeshImpactOptions {
  // A pair nearer than this that doesn't part is a hit [m]: the time is early by at most tolerance / (speed at which
  // they approach), and what passes more closely is taken for a contact. More than the rounding of a place in the
  // world, 2^-46 of its largest coordinate, or else that counts. They stay at least half of it apart until then.
  double tolerance_m = 1e-6;
  std::uint32_t max_iterations = 1u << 18;
  // A pair nearer than the tolerance is a hit however the motion goes on: the query then finds how near things come,
  // not when they touch, and kSeparated says that nothing comes as near as half of the tolerance.
  bool only_distance = false;
};

// Finds when two meshes come to touch, both moving as their states say from time 0 on. A touch that parts is none: a
// pair that was answered a moment ago, and still is nearer than the tolerance, is followed until it comes back.
//
// The step is cut into windows in which nothing turns far. In each, pairs of boxes are followed down from the roots as
// long as their gap along some axis of either may close: at the speed along it, and what turning and acceleration add
// at most. Pairs of triangles that are left advance conservatively, each by itself (Mirtich, PhD, Berkeley 1996): along
// the direction between them, each corner by its speed, less what can bend its way. So a fast thin object does not
// tunnel, however long the step is.
//
// An object keeps its memory. Not thread-safe.
class MeshImpactQuery {
 public:
  [[nodiscard]] MeshImpact first_impact(WideTree& a, const KinematicState& motion_a, WideTree& b,
                                        const KinematicState& motion_b, double step_s,
                                        const MeshImpactOptions& options = {});

 private:
  struct TrianglePair {
    float free_s;  // after a window's begin: they don't touch before
    std::uint32_t a, b;
  };
  class Search;

  WideQuery overlap_;
  std::vector<std::pair<WideTree::ChildSlot, WideTree::ChildSlot>> stack_;
  std::vector<TrianglePair> pairs_;  // the pairs of triangles of a window's leaves
};

}  // namespace peerd::collision
