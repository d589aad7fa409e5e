#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "collision/broad_phase/broad_pair.hpp"
#include "core/box.hpp"

namespace peerd::collision {

// Work done since the beginning.
struct BroadPhaseCounters {
  std::uint64_t box_tests = 0;  // comparisons of two boxes, at a node or end point of a structure as well
  std::uint64_t moves = 0;      // objects whose box differed from that at the last tick
  std::uint64_t refits = 0;     // moves by which an object left its fat box
  // Pairs of objects, each once a tick, that a method passed over since they cannot overlap before a later time.
  std::uint64_t pairs_postponed = 0;
};

// The ways to find candidates. All give the same answers, in the same order.
enum class BroadPhaseMethod : std::uint8_t {
  kBruteForce,     // tests every interest in every tick; the others are checked against it
  kSweepAndPrune,  // sorted ends of boxes along three axes, for pairs and for groups
  kDynamicTree,    // a tree of fat boxes, for pairs and for groups
  kInterestLists,  // an object's own list of interests for pairs, a tree for each group: the default
};

// Finds the registered interests whose boxes overlap. Only pairs that someone is interested in exist at all: those
// registered one by one, and those of two members of a group.
//
// Boxes are closed, in the world frame [m]: touching is overlapping. An empty box (and one with a NaN) overlaps
// nothing; infinite ones are as good as any. Nothing is decided between two ticks. A tick costs what moved since the
// last one and the length of the answer if that changed; one before which nothing moved, came or went tests nothing.
class BroadPhase {
 public:
  virtual ~BroadPhase() = default;

  virtual void add(BroadIndex object, const WorldBox& box) = 0;   // must not be there
  virtual void remove(BroadIndex object) = 0;                     // its interests end, and it leaves its groups
  virtual void move(BroadIndex object, const WorldBox& box) = 0;  // costs nothing where the box is the same

  // Both objects exist. The result is false where the interest was (wasn't) registered already.
  virtual bool register_interest(BroadIndex a, BroadIndex b) = 0;
  virtual bool unregister_interest(BroadIndex a, BroadIndex b) = 0;
  // A group makes interests of all pairs of its members. An object may be in several groups; a pair that has several
  // reasons to exist is reported once.
  virtual bool join(BroadGroup group, BroadIndex object) = 0;
  virtual bool leave(BroadGroup group, BroadIndex object) = 0;

  // Interests whose boxes overlap now, by (low, high), each once. Valid until the next call of tick().
  virtual std::span<const BroadPair> tick() = 0;
  [[nodiscard]] virtual BroadPhaseCounters counters() const = 0;
};

[[nodiscard]] std::unique_ptr<BroadPhase> make_broad_phase(BroadPhaseMethod method = BroadPhaseMethod::kInterestLists);

}  // namespace peerd::collision
