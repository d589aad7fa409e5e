#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/box.hpp"
#include "core/geometry/box_index.hpp"
#include "core/schedule.hpp"
#include "replication/physics/world/moving_objects.hpp"
#include "replication/physics/world/watched_pair.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The broad phase of a MotionWorld. Each body is in a place, a region around its way that is wide enough for some time,
// and a pair is far as long as the places of its two are apart. Nobody checks a far pair, and most of them are nowhere
// listed: a body that leaves its place finds by an index whose places are near the next one. So an object costs a
// comparison with its place whenever it moves otherwise, however many interests name it.
//
// Laws of the past come late, so places are kept for kWorldHistory: what is far is apart from the instant on at which
// it became far, and a law of before that finds by its place then what may have been near.
//
// Pairs with a carrier or with flexible parts, and those of which collision has no exact answer, are always near.
class FarPairs {
 public:
  // All places are known from `start` on.
  FarPairs(const WorldModel& model, SimTime start, MovingObjects& objects);

  // The rule by which pairs are watched from now on.
  void set_rule(IsWatched is_watched) { is_watched_ = std::move(is_watched); }
  [[nodiscard]] const IsWatched& rule() const { return is_watched_; }
  [[nodiscard]] bool is_watched(std::uint32_t pair) const {
    return is_watched_ == nullptr || is_watched_(model_->pairs[pair]);
  }

  // Whether the pair may be far. One that has no WatchedPair then is far.
  [[nodiscard]] bool may_be_far(std::uint32_t pair) const;
  // The pairs that the object's own motion may change, but for far ones that have nothing to remember, ascending. Some
  // have no WatchedPair yet.
  [[nodiscard]] PairNumbers near(std::size_t object, const WatchedPairs& pairs) const {
    const bool are_its_own = object < model_->all_pairs_move.size() && model_->all_pairs_move[object];
    return are_its_own ? PairNumbers(pairs.of_end(object)) : model_->part_pairs_moved_by(object);
  }

  // Opens all pairs that are near at first. Called once.
  void begin(SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // The two are apart at s, by their bounds. Notes the pair as far if their places are apart, too, and returns whether
  // it has. Erases a pair that has nothing to remember; no search begins before `oldest` any more.
  bool add(std::uint32_t pair, SimTime s, SimTime oldest, MovingObjects& objects, WatchedPairs& pairs);
  // Returns the WatchedPair of a pair. Where there is none, the pair is far, and gets one that says that the two were
  // apart before `apart_until`.
  WatchedPair& known(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs);
  // Makes the WatchedPairs of far pairs between one of these objects and any other one whose place is within `within_m`
  // [m] of a place of it. ModelNode::kNone stands for no object. Returns whether there was any to make.
  bool make_near(std::span<const std::uint32_t> objects, double within_m, SimTime apart_until, WatchedPairs& pairs);
  // The object has a new law from t on. Follows it until `until`, and appends pairs that are no longer far to `opened`.
  void moved(std::size_t object, SimTime t, SimTime until, MovingObjects& objects, WatchedPairs& pairs,
             std::vector<std::uint32_t>& opened);
  // Opens the far pairs that have something to remember: the others have no WatchedPair to open.
  void open(WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // Follows all objects until that time.
  void follow(SimTime until, MovingObjects& objects, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // Whether what is far is so at t.
  [[nodiscard]] bool is_known_at(SimTime t) const { return checks_.next_due(0, t) == checks_.size(); }
  // Forgets places, and far pairs with nothing to remember, of which nobody asks from `oldest` on.
  void forget_before(SimTime oldest, WatchedPairs& pairs);
  // Calls `function(object)` for each object that has a place.
  template <class Function>
  void for_each_placed(Function function) const {
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      if (places_[i].exists) function(i);
    }
  }

 private:
  struct Place {
    SweptRegion region;                    // no bound of the body leaves it
    bool exists = false;                   // the object is one rigid body that nothing carries
    std::uint32_t left = 0;                // how many places the object has left
    SimTime since = SimTime::min();        // the body is in it from then on
    SimTime known_until = SimTime::min();  // until then, at least
    SimTime last_added = SimTime::min();   // no pair of the object became far after it
    std::vector<std::uint32_t> before{};   // the places before, the oldest first, into past_
  };
  struct PastPlace {
    std::uint32_t object = 0;
    SweptRegion region;
    SimTime since{}, until{};
  };

  [[nodiscard]] bool is_single(std::uint32_t object) const;
  [[nodiscard]] CollisionType type_of(std::uint32_t pair) const {
    const auto at = model_->part_pairs.locate(pair);
    return at.group != nullptr ? at.group->type() : model_->pairs[model_->part_pairs[pair].pair].type;
  }
  // The box of a place in an index: those of two that are not apart overlap.
  [[nodiscard]] WorldBox box_of(const SweptRegion& region) const;
  [[nodiscard]] static Place place_at(std::size_t object, SimTime s, MovingObjects& objects);
  [[nodiscard]] Place first_place(std::uint32_t object, SimTime start, MovingObjects& objects) const;
  void note_place(std::uint32_t object);
  // The object leaves its place at s, and is in `next` from then on.
  void enter(std::uint32_t object, const Place& next, SimTime s);
  // The object goes back to the place in which it was at t.
  void go_back(std::uint32_t object, SimTime t);
  void erase_past(std::uint32_t slot);
  // Opens the far pairs between the object and all that has been, at `from` or later, in a place that is not apart from
  // the object's place. By the object's laws until now the two were apart until `apart_until`.
  void open_near(std::uint32_t object, SimTime from, SimTime apart_until, WatchedPairs& pairs,
                 std::vector<std::uint32_t>& opened);
  void open_between(std::uint32_t object, std::uint32_t other, const SweptRegion& place_of_other, SimTime apart_until,
                    WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  void open_all(std::uint32_t object, SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  void open_pair(std::uint32_t pair, SimTime apart_until, WatchedPairs& pairs, std::vector<std::uint32_t>& opened);
  // The object has entered its place at s. Erases its WatchedPairs that nobody watches, that have not touched lately,
  // and whose two places are apart: they are far from then on.
  void erase_unwatched(std::uint32_t object, SimTime s, WatchedPairs& pairs);
  [[nodiscard]] bool stays_until(std::size_t object, SimTime until, MovingObjects& objects);

  const WorldModel* model_ = nullptr;
  double reach_ = 1.0;  // how much farther than its radius a place reaches
  IsWatched is_watched_;
  std::vector<Place> places_;  // by the model's nodes
  BoxIndex index_;             // by the model's nodes: their places
  std::vector<PastPlace> past_;
  std::vector<std::uint32_t> free_past_;    // unused ones of past_
  BoxIndex past_index_;                     // by the indices of past_
  Schedule checks_;                         // by the model's nodes: known_until
  std::vector<std::uint32_t> remembering_;  // far pairs that have a WatchedPair, and some that had one
};

// The part pairs of MotionWorld::known_pairs(), in the order in which they came. It is empty until begin().
class KnownPairs {
 public:
  [[nodiscard]] bool has_begun() const { return has_begun_; }
  void begin(const WorldModel& model);
  // Both do nothing before it has begun. The first adds a pair, the second all watched pairs of an object that may be
  // far.
  void note(std::uint32_t part_pair);
  void note_far_of(std::size_t object, const WorldModel& model, const FarPairs& far);
  [[nodiscard]] std::span<const std::uint32_t> pairs() const { return pairs_; }
  std::span<const std::uint32_t> sorted();

 private:
  bool has_begun_ = false;
  std::vector<std::uint32_t> pairs_;
  std::vector<bool> has_pair_, has_pairs_of_;  // by part pair; by the model's nodes
};

}  // namespace peerd::replication
