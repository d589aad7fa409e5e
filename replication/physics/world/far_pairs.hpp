#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/schedule.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The broad phase of a MotionWorld: pairs that nobody checks as long as neither of the two leaves its place, a region
// around the way of its body that is wide enough for some time. An object that moves otherwise, or on, costs a
// comparison with its place, however many interests name it. Where it has left that it gets another place, and its
// pairs with what is not apart from that are opened. Pairs with a carrier or with flexible parts are always near. Most
// far pairs have nothing to remember: they have no WatchedPair, and get a new one where they are opened.
class FarPairs {
 public:
  explicit FarPairs(const WorldModel& model);

  [[nodiscard]] bool contains(std::size_t pair) const { return is_far_[pair]; }
  // The pairs that the object's own motion may change, but for far ones that have nothing to remember, ascending. Some
  // have no WatchedPair yet.
  [[nodiscard]] PairNumbers near(std::size_t object, const WatchedPairs& pairs) const {
    const bool are_its_own = object < model_->all_pairs_move.size() && model_->all_pairs_move[object];
    return are_its_own ? PairNumbers(pairs.of_end(object)) : model_->part_pairs_moved_by(object);
  }

  // The two are apart at s, by their bounds. Notes the pair as far if their places are apart, too, and returns whether
  // it has. Erases a pair that has nothing to remember; no search begins before `oldest` any more.
  bool add(std::uint32_t pair, SimTime s, SimTime oldest, MovingObjects& objects, WatchedPairs& pairs);
  // The same for a watched pair that has waited until s (WaitingPairs::may_wait()) and has no WatchedPair. Its places
  // have to hold the two until `until`, too.
  bool add_waiting(std::uint32_t pair, SimTime s, SimTime until, MovingObjects& objects);
  // The WatchedPair of a watched pair. That of a far one that has none is made: the two were apart before
  // `apart_until`.
  WatchedPair& known(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs) const;
  // Makes those of all far pairs of these objects, of which some may be ModelNode::kNone. Returns whether there was any
  // to make.
  bool make_all_of(std::span<const std::uint32_t> objects, SimTime apart_until, WatchedPairs& pairs) const;
  // The object has a new law from t on. Follows it until `until`, and appends pairs that are no longer far to `opened`.
  void moved(std::size_t object, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
             std::vector<std::uint32_t>& opened);
  // Appends all that is far to `opened`: nothing is far any more.
  void open(WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // Follows all objects until that time.
  void follow(SimTime until, MovingObjects& objects, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // Whether what is far is so at t.
  [[nodiscard]] bool is_known_at(SimTime t) const { return checks_.next_due(0, t) == checks_.size(); }

 private:
  struct Place {
    SweptBound bound;                      // no bound of the body leaves it
    SimTime since = SimTime::max();        // the body is in it from then on; max(): there is no place
    SimTime known_until = SimTime::min();  // until then, at least
    SimTime last_added = SimTime::min();   // no far pair was added, and no far partner's place begins, after it
    std::uint32_t far = 0;                 // the number of its pairs that are far
  };

  [[nodiscard]] bool is_single(std::uint32_t object) const;
  [[nodiscard]] bool may_be_far(const WatchedPair& pair) const;
  // Whether the places of the two hold them from s to `until`, and are apart. Notes the pair as far if so.
  bool add_by_places(std::uint32_t pair, const std::array<std::uint32_t, 2>& ends, SimTime s, SimTime until,
                     MovingObjects& objects);
  [[nodiscard]] CollisionType type_of(std::uint32_t pair) const {
    const auto at = model_->part_pairs.locate(pair);
    return at.group != nullptr ? at.group->type() : model_->pairs[model_->part_pairs[pair].pair].type;
  }
  [[nodiscard]] Place& place_of(std::uint32_t object);
  [[nodiscard]] static Place place_at(std::size_t object, SimTime s, MovingObjects& objects);
  void make_place(std::size_t object, SimTime s, MovingObjects& objects);
  // The object is in `next` from s on; which of its pairs stay far is known from then on.
  static void enter(Place& place, const Place& next, SimTime s);
  // Follows the object, whose law is new from t on, until `until`. Where it leaves its place it gets another one, and
  // pairs whose places are still apart stay far.
  void leave_place(std::size_t object, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
                   std::vector<std::uint32_t>& opened);
  // The two were apart until then.
  void open_pair(std::uint32_t number, SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // Opens those far pairs of the object for which `stays` (the pair, the other object) says no. The object was in the
  // place where they are far until `apart_until`.
  template <class Stays>
  void open_unless(std::size_t object, SimTime apart_until, Stays stays, WatchedPairs& pairs,
                   std::vector<std::uint32_t>& opened);
  [[nodiscard]] bool stays_until(std::size_t object, SimTime until, MovingObjects& objects);
  void open_all(std::size_t object, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);

  const WorldModel* model_ = nullptr;
  SparseTable<Place> places_;       // by the model's nodes: of those that have had a far pair
  Schedule checks_;                 // by object: known_until, where any of its pairs is far
  std::vector<bool> is_far_;        // by pair
  std::vector<bool> was_searched_;  // WatchedPair::searched, of a far pair that has none
};

// The watched pairs of a MotionWorld that wait for one of their two to move: both are one rigid body that nothing
// carries and that has never moved, and in the file they are apart. In a large world most are such pairs, and nothing
// is kept of them but that they wait.
class WaitingPairs {
 public:
  explicit WaitingPairs(const WorldModel& model)
      : model_(&model), waits_(model.pairs.size()), of_node_(model.nodes.size()) {}

  [[nodiscard]] bool contains(std::uint32_t number) const { return waits_[number]; }
  [[nodiscard]] std::size_t count() const { return count_; }
  // Whether the pair of that number in the model may wait.
  [[nodiscard]] bool may_wait(std::uint32_t number, const MovingObjects& objects) const;
  void set(std::uint32_t number, bool waits);
  // The pairs of a node, which wait no more.
  [[nodiscard]] std::vector<std::uint32_t> take_of(std::size_t node);

 private:
  const WorldModel* model_;
  std::vector<bool> waits_;             // by number
  std::vector<std::uint32_t> of_node_;  // how many of its pairs wait
  std::size_t count_ = 0;
};

}  // namespace peerd::replication
