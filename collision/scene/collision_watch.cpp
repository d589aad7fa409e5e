#include "collision/scene/collision_watch.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>

#include "collision/exact/infinity.hpp"
#include "core/scene/interest_pairs.hpp"

namespace peerd::collision {
namespace {

constexpr std::uint32_t kNoObject = ~0u;

}  // namespace

CollisionWatch::CollisionWatch(const Scene& scene, HierarchyLoader load_hierarchy, const CoherenceOptions& options,
                               const WatchEngine& engine)
    : scene_(scene),
      query_(scene, std::move(load_hierarchy)),
      coherence_(options.witnesses),
      object_of_(scene.instances.size(), kNoObject),
      pending_transforms_(scene.transforms),
      options_(engine.narrow_phase == nullptr ? options : CoherenceOptions{false, false}),
      has_narrow_phase_(engine.narrow_phase != nullptr) {
  query_.set_narrow_phase(engine.narrow_phase);
  for (const CollisionInterest& interest : scene.interests) {
    InterestPairs(scene, interest).for_each([&](ObjectId collider, ObjectId collidee) {
      interests_.push_back({collider, collidee, interest.type});
    });
  }
  collisions_.resize(interests_.size());
  add_objects(scene, engine);
  add_pairs();
}

void CollisionWatch::add_objects(const Scene& scene, const WatchEngine& engine) {
  for (const WatchedInterest& interest : interests_) {
    object_of_[scene.index_of(interest.collider)] = object_of_[scene.index_of(interest.collidee)] = 0;
  }
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < object_of_.size(); ++i) {
    if (object_of_[i] != kNoObject) ids.push_back(scene.id_of(i));
  }
  broad_ = engine.make_broad ? engine.make_broad(ids) : make_broad_phase(engine.broad_phase);
  for (std::uint32_t i = 0; i < object_of_.size(); ++i) {
    if (object_of_[i] == kNoObject) continue;
    object_of_[i] = static_cast<BroadIndex>(objects_.size());
    objects_.push_back({.id = scene.id_of(i), .instance = i});
    changes_.add_object(scene.id_of(i), scene.instances[i].kind == NodeKind::kTransform);
    moved_objects_.push_back(object_of_[i]);
    broad_->add(object_of_[i], {});
  }
  for (const WatchedInterest& interest : interests_) {
    changes_.add_interest(object_of(interest.collider), object_of(interest.collidee));
  }
}

void CollisionWatch::add_pairs() {
  const auto objects_of = [&](std::uint32_t i) {
    return make_broad_pair(object_of(interests_[i].collider), object_of(interests_[i].collidee));
  };
  for (std::uint32_t i = 0; i < interests_.size(); ++i) interests_by_pair_.push_back(i);
  std::ranges::stable_sort(interests_by_pair_, {}, objects_of);
  for (std::uint32_t i = 0; i < interests_by_pair_.size(); ++i) {
    const BroadPair objects = objects_of(interests_by_pair_[i]);
    if (pairs_.empty() || pairs_.back().objects != objects) {
      pairs_.push_back({.objects = objects, .begin = i, .end = i});
      broad_->register_interest(objects.low, objects.high);
    }
    ++pairs_.back().end;
    (interests_[interests_by_pair_[i]].type == CollisionType::kBox ? pairs_.back().has_box_interest
                                                                   : pairs_.back().has_shape_interest) = true;
  }
}

void CollisionWatch::move(std::uint32_t transform, const TransformFields& fields) {
  assert(transform < pending_transforms_.size());
  pending_transforms_[transform] = fields;
  moved_transforms_.push_back(transform);
}

void CollisionWatch::set_transforms(std::span<const TransformFields> transforms) {
  assert(transforms.size() == pending_transforms_.size());
  moved_transforms_.clear();
  for (std::uint32_t t = 0; t < transforms.size(); ++t) move(t, transforms[t]);
}

void CollisionWatch::reshape(std::uint32_t geometry, Geometry form) {
  pending_geometries_.insert_or_assign(geometry, std::move(form));
}

const CollisionWatch::Tick& CollisionWatch::tick() {
  ++tick_;
  changes_.begin_tick();
  apply_pending_changes();
  if (!moved_objects_.empty()) {
    counters_.objects_moved += moved_objects_.size();
    for (const BroadIndex i : moved_objects_) {
      Object& object = objects_[i];
      broad_->move(i, query_.box(object.id));
      accumulate_travel(object);
    }
    find_near();
  }
  counters_.pairs_far += pairs_.size() - near_pairs_.size();
  if (moved_objects_.empty()) {
    counters_.pairs_unmoved += near_pairs_.size();
  } else {
    test_near_pairs();
  }
  for (const BroadIndex object : moved_objects_) {
    objects_[object].moved = false;
    objects_[object].displacement_m = 0.0;
  }
  moved_objects_.clear();
  ++counters_.ticks;
  return changes_.end_tick();
}

// The sum is rounded up. An object without a finite displacement is treated as reshaped: no gap is known of it.
void CollisionWatch::accumulate_travel(Object& object) {
  object.displacement_m = query_.displacement_m(object.id);
  if (!(object.displacement_m < kInfinity)) {
    object.displacement_m = 0.0;
    object.reshaped_at_tick = tick_;
  }
  assert(object.displacement_m >= 0.0);
  object.travelled_m = std::nextafter(object.travelled_m + object.displacement_m, kInfinity);
}

// Marks the objects that have the instance in their path, or below them.
void CollisionWatch::mark(std::uint32_t instance) {
  assert(instance < object_of_.size());
  const auto moved = [&](std::uint32_t i) {
    if (object_of_[i] == kNoObject || std::exchange(objects_[object_of_[i]].moved, true)) return;
    moved_objects_.push_back(object_of_[i]);
  };
  const std::uint32_t end = scene_.instances[instance].subtree_end;
  const auto first = std::ranges::lower_bound(objects_, instance, {}, &Object::instance);
  for (auto object = first; object != objects_.end() && object->instance < end; ++object) moved(object->instance);
  for (std::int32_t i = scene_.instances[instance].parent; i >= 0;
       i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    moved(static_cast<std::uint32_t>(i));
  }
}

void CollisionWatch::apply_pending_changes() {
  for (const std::uint32_t transform : moved_transforms_) {
    if (!query_.move(transform, pending_transforms_[transform])) continue;
    for (const std::uint32_t instance : query_.instances_of_transform(transform)) mark(instance);
  }
  moved_transforms_.clear();
  for (const auto& [geometry, form] : pending_geometries_) {
    query_.reshape(geometry, form);
    for (const std::uint32_t instance : query_.instances_of_geometry(geometry)) {
      mark(instance);
      for (auto i = static_cast<std::int32_t>(instance); i >= 0;
           i = scene_.instances[static_cast<std::size_t>(i)].parent) {
        if (const std::uint32_t object = object_of_[static_cast<std::size_t>(i)]; object != kNoObject) {
          objects_[object].reshaped_at_tick = tick_;
        }
      }
    }
  }
  pending_geometries_.clear();
}

// The answer changes little from tick to tick, so that most pairs are where they were.
void CollisionWatch::find_near() {
  std::swap(near_pairs_, previous_near_pairs_);
  near_pairs_.clear();
  auto before = previous_near_pairs_.begin();
  for (const BroadPair objects : broad_->tick()) {
    while (before != previous_near_pairs_.end() && before->objects < objects) clear_pair((before++)->pair);
    if (before != previous_near_pairs_.end() && before->objects == objects) {
      near_pairs_.push_back(*before++);
      continue;
    }
    const auto pair = std::ranges::lower_bound(pairs_, objects, {}, &Pair::objects);
    assert(pair != pairs_.end() && pair->objects == objects);
    near_pairs_.push_back({.objects = objects, .pair = static_cast<std::uint32_t>(pair - pairs_.begin())});
  }
  while (before != previous_near_pairs_.end()) clear_pair((before++)->pair);
}

// The boxes of this pair are apart now.
void CollisionWatch::clear_pair(std::uint32_t pair) {
  for (std::uint32_t i = pairs_[pair].begin; i < pairs_[pair].end; ++i) {
    changes_.accept(interests_by_pair_[i]);
    set_colliding(interests_by_pair_[i], false);
  }
}

// Every pair that became near has a member that moved.
void CollisionWatch::test_near_pairs() {
  for (NearPair& near : near_pairs_) {
    if (objects_[near.objects.low].moved || objects_[near.objects.high].moved) {
      test_pair(near);
    } else {
      ++counters_.pairs_unmoved;
    }
  }
}

// Several interests in one pair, and interests above and below each other, come to the same pairs of Shapes, which
// remember the tick.
void CollisionWatch::test_pair(NearPair& near) {
  const Pair& pair = pairs_[near.pair];
  assert(pair.begin < pair.end && pair.end <= interests_by_pair_.size());
  const bool separated = pair.has_shape_interest && is_separated(near);
  if (separated) {
    ++counters_.pairs_separated;
    if (!pair.has_box_interest) return;  // as at the last tick
  } else {
    ++counters_.pairs_queried;
  }
  const bool apart = separated || (pair.has_shape_interest && find_gap(near));
  near.touching = false;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    const std::uint32_t interest = interests_by_pair_[i];
    changes_.accept(interest);
    const bool has_box_interest = interests_[interest].type == CollisionType::kBox;
    const bool colliding = has_box_interest ? boxes_collide(interest) : !apart && shapes_collide(interest, near);
    near.touching |= !has_box_interest && (colliding || changes_.is_refused(interest));
    if (changes_.is_colliding(interest)) collisions_[interest].reset();
    set_colliding(interest, colliding);
  }
}

bool CollisionWatch::is_separated(const NearPair& near) const {
  const Object &low = objects_[near.objects.low], &high = objects_[near.objects.high];
  const double travelled_m = low.travelled_m + high.travelled_m, rounding_m = 0x1p-51 * travelled_m;
  assert(travelled_m >= near.travelled_m || near.gap_m == 0.0);
  return low.reshaped_at_tick <= near.gap_tick && high.reshaped_at_tick <= near.gap_tick &&
         travelled_m - near.travelled_m + rounding_m < near.gap_m;
}

// A gap is sought that would last for some ticks of the present motion: more where the last one was found, fewer where
// there was none so wide; and none for a while after that.
bool CollisionWatch::find_gap(NearPair& near) {
  constexpr int kLongestHorizon = 64;
  constexpr std::uint8_t kMostFailures = 5;
  near.gap_m = 0.0;
  if (!options_.gaps || near.touching) return false;
  if (near.pause > 0) {
    --near.pause;
    return false;
  }
  const Object &low = objects_[near.objects.low], &high = objects_[near.objects.high];
  const double gap_m = (low.displacement_m + high.displacement_m) * near.horizon;
  if (!(gap_m > 0.0 && std::isfinite(gap_m))) return false;  // in the first tick
  assert(near.horizon >= 1 && near.failures <= kMostFailures);
  ++counters_.gap_searches;
  if (query_.separated_by(low.id, high.id, gap_m)) {
    ++counters_.gaps_found;
    near.gap_m = gap_m;
    near.travelled_m = low.travelled_m + high.travelled_m;
    near.gap_tick = tick_;
    near.horizon = static_cast<std::uint16_t>(std::min(near.horizon + (near.horizon + 3) / 4, kLongestHorizon));
    near.failures = 0;
    return true;
  }
  near.horizon = static_cast<std::uint16_t>(std::max(near.horizon / 2, 1));
  if (near.failures < kMostFailures) ++near.failures;
  near.pause = static_cast<std::uint8_t>((1u << near.failures) - 1);
  return false;
}

bool CollisionWatch::refuse(std::uint32_t interest, const std::string& why) {
  changes_.refuse(interest, why);
  return false;
}

bool CollisionWatch::boxes_collide(std::uint32_t interest) {
  ++counters_.boxes_queried;
  const auto& [collider, collidee, type] = interests_[interest];
  const auto boxes = query_.collide(collider, collidee, type);
  return boxes ? boxes->colliding : refuse(interest, boxes.error());
}

// All close pairs are visited for kAllPairs, since one may be refused; but pairs are tested only until two touch.
bool CollisionWatch::shapes_collide(std::uint32_t interest, NearPair& near) {
  const auto& [collider, collidee, type] = interests_[interest];
  if (has_narrow_phase_) {
    const auto found = query_.collide(collider, collidee, type);
    return found ? found->colliding : refuse(interest, found.error());
  }
  bool touching = false;
  const bool all = type == CollisionType::kAllPairs;
  const auto visit = [&](const SceneQuery::ClosePair& close) {
    touching = touching || coherence_.touch(close, tick_, near.hint);
    return touching && !all;
  };
  const auto searched = query_.visit_close_pairs(collider, collidee, std::ref(visit));
  return searched ? touching : refuse(interest, searched.error());
}

void CollisionWatch::set_colliding(std::uint32_t interest, bool colliding) {
  if (changes_.set_colliding(interest, colliding) && !colliding) collisions_[interest].reset();
}

const Collision& CollisionWatch::collision(std::uint32_t interest) {
  static const Collision kNoCollision;
  assert(interest < interests_.size());
  if (!changes_.is_colliding(interest)) return kNoCollision;
  std::optional<Collision>& known = collisions_[interest];
  if (!known) {
    const auto& [collider, collidee, type] = interests_[interest];
    known = query_.collide(collider, collidee, type).value();
  }
  return *known;
}

CollisionWatchCounters CollisionWatch::counters() const {
  CollisionWatchCounters out = counters_;
  out.shapes = coherence_.counters();
  out.broad = broad_->counters();
  out.pairs_postponed = out.broad.pairs_postponed;
  out.pairs_far -= out.pairs_postponed;  // the broad phase does not say which of the others are
  out.query = query_.counters();
  QueryCounters& sum = out.query.queries;
  const QueryCounters& ticks = coherence_.query_counters();
  sum.bv_tests += ticks.bv_tests;
  sum.bv_updates += ticks.bv_updates;
  sum.triangle_tests += ticks.triangle_tests;
  sum.orientation.exact += ticks.orientation.exact;
  sum.orientation.wide += ticks.orientation.wide;
  return out;
}

}  // namespace peerd::collision
