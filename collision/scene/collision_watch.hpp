#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "collision/broad_phase/broad_phase.hpp"
#include "collision/scene/collision_changes.hpp"
#include "collision/scene/pair_coherence.hpp"
#include "collision/scene/scene_query.hpp"

namespace peerd::collision {

// One of a scene's interests: a collider, one of its collidees (never itself), and the type of the answer.
struct WatchedInterest {
  ObjectId collider, collidee;
  CollisionType type = CollisionType::kBox;
};

// The caches that are kept from tick to tick. Answers don't depend on them.
struct CoherenceOptions {
  bool witnesses = true;  // the leaves where two Shapes touched are tested first
  bool gaps = true;       // a certified gap: nothing is tested until the objects may have closed it
};

// Another way to find collisions than ours. With a narrow phase of its own nothing is kept from tick to tick.
struct WatchEngine {
  NarrowPhase* narrow_phase = nullptr;  // null: ours; it outlives the watch
  BroadPhaseMethod broad_phase = BroadPhaseMethod::kInterestLists;
  // Makes another broad phase than those methods, of the objects that interests name, by BroadIndex; none: as they are.
  std::function<std::unique_ptr<BroadPhase>(std::span<const ObjectId>)> make_broad{};
};

// Work done since the beginning.
struct CollisionWatchCounters {
  std::uint64_t ticks = 0;
  std::uint64_t objects_moved = 0;  // objects in whose path, or below which, something has moved
  // Pairs of objects, each once a tick.
  std::uint64_t pairs_postponed = 0;  // passed over: BroadPhaseCounters::pairs_postponed
  std::uint64_t pairs_far = 0;        // passed over: their boxes are apart
  std::uint64_t pairs_unmoved = 0;    // passed over: near, but neither has moved since the answer
  std::uint64_t pairs_separated = 0;  // passed over: they have not gone as far as they were apart
  std::uint64_t pairs_queried = 0;    // all others
  std::uint64_t gap_searches = 0;     // searches for a gap, at most one for each of pairs_queried
  std::uint64_t gaps_found = 0;     // searches that found a gap as wide as was sought, so that nothing more was tested
  std::uint64_t boxes_queried = 0;  // interests of type kBox tested
  PairCoherence::Counters shapes;   // the close pairs of Shapes of the pairs queried
  BroadPhaseCounters broad;
  SceneQueryCounters query;  // its `queries` with those of all ticks
};

// Finds which of a scene's registered interests collide, tick after tick, and what began and ended: by the broad phase
// over the boxes of the objects that interests name, then by the exact questions of SceneQuery, for what moved only.
//
// A tick's answer is what a new SceneQuery would give for the same placement, whatever was queried before. One
// exception: a witness where a hierarchy was refitted (SceneQuery::reshape()) is another true one. A tick costs what
// moved since the last one, the pairs of objects that are near, and the answer if that changed; one before which
// nothing moved costs nothing. Memory grows with the pairs of objects that are, or lately were, near. Not thread-safe.
class CollisionWatch {
 public:
  explicit CollisionWatch(const Scene& scene, HierarchyLoader load_hierarchy = {}, const CoherenceOptions& options = {},
                          const WatchEngine& engine = {});

  // All interests, in file order; an interest is named by its index in this list.
  [[nodiscard]] std::span<const WatchedInterest> interests() const { return interests_; }

  // Sets what kBox compares from the next tick on; to be called before the first tick.
  void set_box_bound(BoxBound bound) { query_.set_box_bound(bound); }

  // Changes made between two ticks count from the next tick on. Transforms and geometries are named by their indices in
  // Scene; before their first change they are as the file has them.
  void move(std::uint32_t transform, const TransformFields& fields);
  void set_transforms(std::span<const TransformFields> transforms);  // all; those that differ have moved
  void reshape(std::uint32_t geometry, Geometry form);

  using NotColliding = collision::NotColliding;
  using Refused = RefusedInterest;
  using Tick = CollisionChanges::Tick;
  // Applies what was said since the last tick, and answers; valid until the next tick. An interest is refused where
  // SceneQuery has no answer, with its error; one whose other object has nothing that can collide has an answer.
  const Tick& tick();

  // Whether an interest collides, as of the last tick.
  [[nodiscard]] bool is_colliding(std::uint32_t interest) const { return changes_.is_colliding(interest); }

  // The answer of SceneQuery::collide() for an interest, as of the last tick; there must have been one. Pairs of
  // polygons are searched at the first call, and kept as long as nothing moves. Valid until the next tick.
  [[nodiscard]] const Collision& collision(std::uint32_t interest);

  [[nodiscard]] const std::vector<std::string>& notes() const { return query_.notes(); }
  [[nodiscard]] CollisionWatchCounters counters() const;

 private:
  struct Object {
    ObjectId id;
    std::uint32_t instance = 0;   // its index
    bool moved = true;            // since the last tick
    double displacement_m = 0.0;  // a bound of how far its points went in this tick
    double travelled_m = 0.0;     // the sum of displacement_m over all ticks, rounded up
    std::uint64_t reshaped_at_tick = 0;
  };
  struct Pair {  // two objects that interests join
    BroadPair objects;
    std::uint32_t begin = 0, end = 0;  // a range of interests_by_pair_
    bool has_box_interest = false, has_shape_interest = false;
  };
  struct NearPair {
    BroadPair objects;
    std::uint32_t pair = 0;  // its index in pairs_
    std::uint32_t hint = 0;  // PairCoherence's
    // No two points that can collide were nearer than gap_m [m] when the two objects together had gone travelled_m; 0
    // where no gap is known. Boxes and trees have room for rounding many times over, so there is enough of it at both
    // ends of a way.
    double gap_m = 0.0, travelled_m = 0.0;
    std::uint64_t gap_tick = 0;  // the tick
    std::uint16_t horizon = 4;   // the number of ticks of the present motion that a gap is sought for
    std::uint8_t failures = 0;   // searches in a row that found no gap
    std::uint8_t pause = 0;      // searches to leave out
    bool touching = false;       // an exact interest of the pair collided, or was refused, at the last tick
  };

  [[nodiscard]] BroadIndex object_of(ObjectId id) const { return object_of_[scene_.index_of(id)]; }
  void add_objects(const Scene& scene, const WatchEngine& engine);
  void add_pairs();
  void mark(std::uint32_t instance);
  void apply_pending_changes();
  void accumulate_travel(Object& object);
  void find_near();
  void test_near_pairs();
  void test_pair(NearPair& near);
  [[nodiscard]] bool is_separated(const NearPair& near) const;
  [[nodiscard]] bool find_gap(NearPair& near);
  [[nodiscard]] bool shapes_collide(std::uint32_t interest, NearPair& near);
  [[nodiscard]] bool boxes_collide(std::uint32_t interest);
  bool refuse(std::uint32_t interest, const std::string& why);
  void clear_pair(std::uint32_t pair);
  void set_colliding(std::uint32_t interest, bool colliding);

  const Scene& scene_;
  SceneQuery query_;
  PairCoherence coherence_;
  std::unique_ptr<BroadPhase> broad_;
  std::vector<WatchedInterest> interests_;
  std::vector<Object> objects_;                   // by BroadIndex, in the order of ids
  std::vector<std::uint32_t> object_of_;          // by instance: BroadIndex or kNoObject
  std::vector<Pair> pairs_;                       // sorted
  std::vector<std::uint32_t> interests_by_pair_;  // interests

  // Changes since the last tick.
  std::vector<std::uint32_t> moved_transforms_;
  std::vector<TransformFields> pending_transforms_;  // by transform
  std::map<std::uint32_t, Geometry> pending_geometries_;

  std::vector<BroadIndex> moved_objects_;
  std::vector<NearPair> near_pairs_, previous_near_pairs_;  // sorted
  std::vector<std::optional<Collision>> collisions_;        // by interest, where collision() was called
  CollisionChanges changes_;
  std::uint64_t tick_ = 0;
  CoherenceOptions options_;
  bool has_narrow_phase_;
  CollisionWatchCounters counters_;
};

}  // namespace peerd::collision
