#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "collision/broad_phase/broad_phase.hpp"
#include "core/math.hpp"

namespace peerd::collision::engines {

// How an object goes on from now, world frame: before end_s, h seconds from now, every point of it is where it was plus
// velocity * h, and off that by spread * h + acceleration * h^2 / 2 at most, in any direction.
struct SpaceTimeBound {
  Vec3 velocity_m_s = Vec3::Zero();
  double spread_m_s = 0.0;         // a bound of how much the points' present velocities differ from `velocity`
  double acceleration_m_s2 = 0.0;  // a bound of every point's acceleration until end_s
  // Before now: nothing is known of the object.
  double end_s = -std::numeric_limits<double>::infinity();
  double rounding_m = 0.0;  // room for the rounding of its places until then
};

// Knows the time, and bounds how objects go on from it.
class SpaceTime {
 public:
  virtual ~SpaceTime() = default;
  [[nodiscard]] virtual double now_s() const = 0;
  [[nodiscard]] virtual SpaceTimeBound bound(BroadIndex object) = 0;
};

// The first time from now on at which two boxes may overlap, now being now_s, where they are apart now: no later than
// any of these times, and no later than the end of a bound. now_s where they overlap, or where numbers overflow.
[[nodiscard]] double earliest_overlap_s(const WorldBox& a, const SpaceTimeBound& of_a, const WorldBox& b,
                                        const SpaceTimeBound& of_b, double now_s);

// A broad phase by space-time bounds (Hubbard, "Collision detection for interactive graphics applications", IEEE
// Transactions on Visualization and Computer Graphics 1(3), 1995). An object's place in the near future is bounded in
// four dimensions: each side of its box is a parabola over time. Two objects whose boxes are apart need no test before
// the first time at which the sides may meet, so each pair has a time step of its own, and a tick tests the pairs that
// are due alone: neither a fixed time step nor all pairs. Hubbard bounds spheres, by one acceleration for each object,
// and encloses the parabolas in four-dimensional trapezoids whose faces he sorts; here are boxes, and a queue of pairs.
//
// The answers are those of any BroadPhase, at each tick: no pair is late. The boxes of moved objects are where
// SpaceTime's bounds allow; time never decreases.
class SpaceTimeBroadPhase : public BroadPhase {
 public:
  explicit SpaceTimeBroadPhase(SpaceTime& space_time) : space_time_(space_time) {}  // it outlives this object

  void add(BroadIndex object, const WorldBox& box) override;
  void remove(BroadIndex object) override;
  void move(BroadIndex object, const WorldBox& box) override;
  bool register_interest(BroadIndex a, BroadIndex b) override;
  bool unregister_interest(BroadIndex a, BroadIndex b) override;
  bool join(BroadGroup group, BroadIndex object) override;
  bool leave(BroadGroup group, BroadIndex object) override;
  std::span<const BroadPair> tick() override;
  [[nodiscard]] BroadPhaseCounters counters() const override { return counters_; }

 private:
  struct Pair {
    std::uint32_t reasons = 0;  // an interest, and groups
    bool is_registered = false;
    bool overlaps = false;        // at tested_at
    std::uint64_t tested_at = 0;  // the number of the tick
    double due_s = 0.0;
  };
  void add_reason(BroadPair pair);
  void drop_reason(BroadPair pair);
  void erase(std::map<BroadPair, Pair>::iterator pair);

  SpaceTime& space_time_;
  struct Object {
    WorldBox box;
    std::uint64_t changed_at = 0;  // the number of the tick that sees this box first
  };
  std::vector<Object> objects_;  // by BroadIndex
  std::uint64_t tick_ = 1;       // the next one
  std::map<BroadPair, Pair> pairs_;
  std::set<std::pair<double, BroadPair>> queue_;  // of all pairs, by when each is due
  std::map<BroadGroup, std::set<BroadIndex>> groups_;
  std::vector<std::pair<double, BroadPair>> due_;  // scratch of tick()
  std::vector<BroadPair> answer_;
  BroadPhaseCounters counters_;
};

}  // namespace peerd::collision::engines
