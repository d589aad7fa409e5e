#include "collision/scene/collision_watch.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

namespace peerd::collision {
namespace {

constexpr std::uint32_t kNone = ~0u;

}  // namespace

CollisionWatch::CollisionWatch(const Scene& scene, HierarchyLoader load_hierarchy, const CoherenceOptions& options)
    : scene_(scene),
      query_(scene, std::move(load_hierarchy)),
      coherence_(options.witnesses),
      broad_(make_broad_phase()),
      object_of_(scene.instances.size(), kNone),
      said_(scene.transforms),
      options_(options) {
  for (const CollisionInterest& interest : scene.interests) {
    for (const ObjectId collidee : interest.collidees) {
      assert(collidee != interest.collider);
      interests_.push_back({interest.collider, collidee, interest.type});
    }
  }
  is_colliding_.resize(interests_.size());
  collisions_.resize(interests_.size());
  add_objects(scene);
  add_pairs();
}

void CollisionWatch::add_objects(const Scene& scene) {
  for (const WatchedInterest& interest : interests_) {
    object_of_[interest.collider.value] = object_of_[interest.collidee.value] = 0;
  }
  for (std::uint32_t i = 0; i < object_of_.size(); ++i) {
    if (object_of_[i] == kNone) continue;
    object_of_[i] = static_cast<BroadIndex>(objects_.size());
    objects_.push_back({.id = {i}, .is_transform = scene.instances[i].kind == NodeKind::kTransform});
    moved_objects_.push_back(object_of_[i]);
    broad_->add(object_of_[i], {});
  }
}

void CollisionWatch::add_pairs() {
  const auto objects_of = [&](std::uint32_t i) {
    return make_broad_pair(object_of_[interests_[i].collider.value], object_of_[interests_[i].collidee.value]);
  };
  for (std::uint32_t i = 0; i < interests_.size(); ++i) by_pair_.push_back(i);
  std::ranges::stable_sort(by_pair_, {}, objects_of);
  for (std::uint32_t i = 0; i < by_pair_.size(); ++i) {
    const BroadPair objects = objects_of(by_pair_[i]);
    if (pairs_.empty() || pairs_.back().objects != objects) {
      pairs_.push_back({.objects = objects, .begin = i, .end = i});
      broad_->register_interest(objects.low, objects.high);
    }
    ++pairs_.back().end;
    (interests_[by_pair_[i]].type == CollisionType::kBox ? pairs_.back().asks_boxes : pairs_.back().asks_shapes) = true;
  }
}

void CollisionWatch::move(std::uint32_t transform, const TransformFields& fields) {
  said_[transform] = fields;
  moved_transforms_.push_back(transform);
}

void CollisionWatch::place(std::span<const TransformFields> transforms) {
  assert(transforms.size() == said_.size());
  moved_transforms_.clear();
  for (std::uint32_t t = 0; t < transforms.size(); ++t) move(t, transforms[t]);
}

void CollisionWatch::reshape(std::uint32_t geometry, Geometry form) {
  reshaped_.insert_or_assign(geometry, std::move(form));
}

const CollisionWatch::Tick& CollisionWatch::tick() {
  ++tick_;
  began_.clear();
  ended_.clear();
  not_colliding_.clear();
  move_what_was_said();
  if (!moved_objects_.empty()) {
    counters_.objects_moved += moved_objects_.size();
    for (const BroadIndex i : moved_objects_) {
      Object& object = objects_[i];
      broad_->move(i, query_.box(object.id));
      go(object);
    }
    find_near();
  }
  counters_.pairs_far += pairs_.size() - near_.size();
  if (moved_objects_.empty()) {
    counters_.pairs_unmoved += near_.size();
  } else {
    ask_near();
  }
  for (const BroadIndex object : moved_objects_) {
    objects_[object].moved = false;
    objects_[object].way_m = 0.0;
  }
  moved_objects_.clear();
  tell();
  return answer_;
}

// Its sum is rounded up. What has gone nowhere in particular is as good as reshaped: no gap is known of it.
void CollisionWatch::go(Object& object) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  object.way_m = query_.way_m(object.id);
  if (!(object.way_m < kInfinity)) {
    object.way_m = 0.0;
    object.reshaped_at = tick_;
  }
  object.gone_m = std::nextafter(object.gone_m + object.way_m, kInfinity);
}

// The objects that have the instance in their path, or below them.
void CollisionWatch::mark(std::uint32_t instance) {
  const auto moved = [&](std::uint32_t i) {
    if (object_of_[i] == kNone || std::exchange(objects_[object_of_[i]].moved, true)) return;
    moved_objects_.push_back(object_of_[i]);
  };
  const std::uint32_t end = scene_.instances[instance].subtree_end;
  const auto first = std::ranges::lower_bound(objects_, ObjectId{instance}, {}, &Object::id);
  for (auto object = first; object != objects_.end() && object->id.value < end; ++object) moved(object->id.value);
  for (std::int32_t i = scene_.instances[instance].parent; i >= 0;
       i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    moved(static_cast<std::uint32_t>(i));
  }
}

void CollisionWatch::move_what_was_said() {
  for (const std::uint32_t transform : moved_transforms_) {
    if (!query_.move(transform, said_[transform])) continue;
    for (const std::uint32_t instance : query_.instances_of_transform(transform)) mark(instance);
  }
  moved_transforms_.clear();
  for (const auto& [geometry, form] : reshaped_) {
    query_.reshape(geometry, form);
    for (const std::uint32_t instance : query_.instances_of_geometry(geometry)) {
      mark(instance);
      for (auto i = static_cast<std::int32_t>(instance); i >= 0;
           i = scene_.instances[static_cast<std::size_t>(i)].parent) {
        if (const std::uint32_t object = object_of_[static_cast<std::size_t>(i)]; object != kNone) {
          objects_[object].reshaped_at = tick_;
        }
      }
    }
  }
  reshaped_.clear();
}

// The answer changes little from tick to tick, so that most pairs are where they were.
void CollisionWatch::find_near() {
  std::swap(near_, near_before_);
  near_.clear();
  auto before = near_before_.begin();
  for (const BroadPair objects : broad_->tick()) {
    while (before != near_before_.end() && before->objects < objects) leave((before++)->pair);
    if (before != near_before_.end() && before->objects == objects) {
      near_.push_back(*before++);
      continue;
    }
    const auto pair = std::ranges::lower_bound(pairs_, objects, {}, &Pair::objects);
    near_.push_back({.objects = objects, .pair = static_cast<std::uint32_t>(pair - pairs_.begin())});
  }
  while (before != near_before_.end()) leave((before++)->pair);
}

// Their boxes are apart now.
void CollisionWatch::leave(std::uint32_t pair) {
  for (std::uint32_t i = pairs_[pair].begin; i < pairs_[pair].end; ++i) {
    refusals_changed_ |= refusals_.erase(by_pair_[i]) > 0;
    answer(by_pair_[i], false);
  }
}

// What became near has moved.
void CollisionWatch::ask_near() {
  for (Near& near : near_) {
    if (objects_[near.objects.low].moved || objects_[near.objects.high].moved) {
      ask(near);
    } else {
      ++counters_.pairs_unmoved;
    }
  }
}

// Several interests in one pair, and interests above and below each other, come to the same pairs of Shapes, which
// remember the tick.
void CollisionWatch::ask(Near& near) {
  const Pair& pair = pairs_[near.pair];
  const bool separated = pair.asks_shapes && is_separated(near);
  if (separated) {
    ++counters_.pairs_separated;
    if (!pair.asks_boxes) return;  // as at the last tick
  } else {
    ++counters_.pairs_asked;
  }
  const bool apart = separated || (pair.asks_shapes && find_gap(near));
  near.touching = false;
  for (std::uint32_t i = pair.begin; i < pair.end; ++i) {
    const std::uint32_t interest = by_pair_[i];
    refusals_changed_ |= refusals_.erase(interest) > 0;
    const bool asks_boxes = interests_[interest].type == CollisionType::kBox;
    const bool colliding = asks_boxes ? boxes_collide(interest) : !apart && shapes_collide(interest, near);
    near.touching |= !asks_boxes && (colliding || refusals_.contains(interest));
    if (is_colliding_[interest]) collisions_[interest].reset();
    answer(interest, colliding);
  }
}

bool CollisionWatch::is_separated(const Near& near) const {
  const Object &low = objects_[near.objects.low], &high = objects_[near.objects.high];
  const double gone_m = low.gone_m + high.gone_m, rounding_m = 0x1p-51 * gone_m;
  return low.reshaped_at <= near.gap_at && high.reshaped_at <= near.gap_at &&
         gone_m - near.gone_m + rounding_m < near.gap_m;
}

// A gap is sought that would last for some ticks of the present motion: more where the last one was found, fewer where
// there was none so wide; and none for a while after that.
bool CollisionWatch::find_gap(Near& near) {
  constexpr int kLongestHorizon = 64;
  constexpr std::uint8_t kMostFailures = 5;
  near.gap_m = 0.0;
  if (!options_.gaps || near.touching) return false;
  if (near.pause > 0) {
    --near.pause;
    return false;
  }
  const Object &low = objects_[near.objects.low], &high = objects_[near.objects.high];
  const double gap_m = (low.way_m + high.way_m) * near.horizon;
  if (!(gap_m > 0.0 && std::isfinite(gap_m))) return false;  // in the first tick
  ++counters_.gaps_sought;
  if (query_.apart_by(low.id, high.id, gap_m)) {
    ++counters_.gaps_found;
    near.gap_m = gap_m;
    near.gone_m = low.gone_m + high.gone_m;
    near.gap_at = tick_;
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
  refusals_[interest] = why;
  refusals_changed_ = true;
  return false;
}

bool CollisionWatch::boxes_collide(std::uint32_t interest) {
  ++counters_.boxes_asked;
  const auto& [collider, collidee, type] = interests_[interest];
  const auto boxes = query_.collide(collider, collidee, type);
  return boxes ? boxes->colliding : refuse(interest, boxes.error());
}

// All pairs are looked at for one that would be refused; but tested only until two touch.
bool CollisionWatch::shapes_collide(std::uint32_t interest, Near& near) {
  const auto& [collider, collidee, type] = interests_[interest];
  bool touching = false;
  const bool all = type == CollisionType::kAllPairs;
  const auto visit = [&](const SceneQuery::ClosePair& close) {
    touching = touching || coherence_.touch(close, tick_, near.hint);
    return touching && !all;
  };
  const auto searched = query_.visit_close_pairs(collider, collidee, std::ref(visit));
  return searched ? touching : refuse(interest, searched.error());
}

void CollisionWatch::answer(std::uint32_t interest, bool colliding) {
  if (static_cast<bool>(is_colliding_[interest]) == colliding) return;
  is_colliding_[interest] = colliding;
  (colliding ? began_ : ended_).push_back(interest);
  for (const ObjectId id : {interests_[interest].collider, interests_[interest].collidee}) {
    Object& object = objects_[object_of_[id.value]];
    object.collisions += colliding ? 1u : ~0u;
    if (!std::exchange(object.changed, true)) changed_objects_.push_back(object_of_[id.value]);
  }
  if (!colliding) collisions_[interest].reset();
}

void CollisionWatch::tell() {
  ++counters_.ticks;
  if (!began_.empty() || !ended_.empty()) {
    std::ranges::sort(began_);
    std::ranges::sort(ended_);
    merged_.clear();
    std::ranges::set_difference(colliding_, ended_, std::back_inserter(merged_));
    colliding_.clear();
    std::ranges::merge(merged_, began_, std::back_inserter(colliding_));
  }
  std::ranges::sort(changed_objects_);
  for (const BroadIndex i : changed_objects_) {
    Object& object = objects_[i];
    object.changed = false;
    const bool colliding = object.collisions > 0;
    if (std::exchange(object.was_colliding, colliding) != colliding && object.is_transform) {
      not_colliding_.push_back({object.id, !colliding});
    }
  }
  changed_objects_.clear();
  if (std::exchange(refusals_changed_, false)) {
    refused_.clear();
    for (const auto& [interest, why] : refusals_) refused_.push_back({interest, why});
  }
  answer_ = {colliding_, began_, ended_, not_colliding_, refused_};
}

const Collision& CollisionWatch::collision(std::uint32_t interest) {
  static const Collision kNoCollision;
  if (!is_colliding_[interest]) return kNoCollision;
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
