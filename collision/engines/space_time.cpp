#include "collision/engines/space_time.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/engines/volume_tree.hpp"

namespace peerd::collision::engines {
namespace {

// A pair that is due at each tick.
constexpr double kAlways_s = -std::numeric_limits<double>::infinity();

bool overlap_of(const WorldBox& a, const WorldBox& b) {
  if (a.is_empty() || b.is_empty()) return false;
  for (int i = 0; i < 3; ++i) {
    if (!(a.lo[i] <= b.hi[i] && b.lo[i] <= a.hi[i])) return false;
  }
  return true;
}

// The first h >= 0 [s] at which speed * h + acceleration * h^2 / 2 may reach a gap > 0 [m], rounded down.
double closing_time_s(double gap_m, double speed_m_s, double acceleration_m_s2) {
  assert(gap_m > 0.0 && acceleration_m_s2 >= 0.0);
  double h = 0.0;
  if (acceleration_m_s2 == 0.0) {
    if (speed_m_s <= 0.0) return std::numeric_limits<double>::infinity();
    h = gap_m / speed_m_s;
  } else {
    const double root = std::sqrt(speed_m_s * speed_m_s + 2.0 * acceleration_m_s2 * gap_m);
    h = speed_m_s >= 0.0 ? 2.0 * gap_m / (speed_m_s + root) : (root - speed_m_s) / acceleration_m_s2;
  }
  return h * (1.0 - 0x1p-40);
}

}  // namespace

double earliest_overlap_s(const WorldBox& a, const SpaceTimeBound& of_a, const WorldBox& b, const SpaceTimeBound& of_b,
                          double now_s) {
  const double spread = of_a.spread_m_s + of_b.spread_m_s;
  const double acceleration = of_a.acceleration_m_s2 + of_b.acceleration_m_s2;
  const double room_m = kRounding * (largest_coordinate(a) + largest_coordinate(b)) + of_a.rounding_m + of_b.rounding_m;
  double wait_s = 0.0;  // the boxes overlap only where they do along all three axes
  for (int i = 0; i < 3; ++i) {
    const double closing = of_a.velocity_m_s[i] - of_b.velocity_m_s[i];
    const double above = b.lo[i] - a.hi[i] - room_m, below = a.lo[i] - b.hi[i] - room_m;
    if (above > 0.0) wait_s = std::max(wait_s, closing_time_s(above, spread + closing, acceleration));
    if (below > 0.0) wait_s = std::max(wait_s, closing_time_s(below, spread - closing, acceleration));
  }
  // Times are rounded, too, and the end of a bound is where an object may jump.
  const double due_s = std::min({now_s + wait_s, of_a.end_s, of_b.end_s});
  const double early_s = due_s - kRounding * (std::abs(now_s) + std::abs(due_s));
  if (due_s == std::numeric_limits<double>::infinity()) return due_s;
  return early_s > now_s ? early_s : now_s;
}

void SpaceTimeBroadPhase::add(BroadIndex object, const WorldBox& box) {
  if (objects_.size() <= object) objects_.resize(object + 1);
  objects_[object] = {box, tick_};
}

void SpaceTimeBroadPhase::remove(BroadIndex object) {
  assert(object < objects_.size());
  for (auto pair = pairs_.begin(); pair != pairs_.end();) {
    const auto next = std::next(pair);
    if (pair->first.low == object || pair->first.high == object) erase(pair);
    pair = next;
  }
  for (auto& [number, group] : groups_) group.erase(object);
}

void SpaceTimeBroadPhase::move(BroadIndex object, const WorldBox& box) {
  assert(object < objects_.size());
  if (objects_[object].box == box) return;
  objects_[object] = {box, tick_};
  ++counters_.moves;
}

void SpaceTimeBroadPhase::erase(std::map<BroadPair, Pair>::iterator pair) {
  queue_.erase({pair->second.due_s, pair->first});
  pairs_.erase(pair);
}

void SpaceTimeBroadPhase::add_reason(BroadPair pair) {
  const auto [known, is_new] = pairs_.try_emplace(pair, Pair{.due_s = kAlways_s});
  if (is_new) queue_.emplace(kAlways_s, pair);
  ++known->second.reasons;
}

void SpaceTimeBroadPhase::drop_reason(BroadPair pair) {
  const auto known = pairs_.find(pair);
  assert(known != pairs_.end() && known->second.reasons > 0);
  if (--known->second.reasons == 0) erase(known);
}

bool SpaceTimeBroadPhase::register_interest(BroadIndex a, BroadIndex b) {
  const BroadPair pair = make_broad_pair(a, b);
  const auto known = pairs_.find(pair);
  if (known != pairs_.end() && known->second.is_registered) return false;
  add_reason(pair);
  pairs_.at(pair).is_registered = true;
  return true;
}

bool SpaceTimeBroadPhase::unregister_interest(BroadIndex a, BroadIndex b) {
  const BroadPair pair = make_broad_pair(a, b);
  const auto known = pairs_.find(pair);
  if (known == pairs_.end() || !known->second.is_registered) return false;
  known->second.is_registered = false;
  drop_reason(pair);
  return true;
}

bool SpaceTimeBroadPhase::join(BroadGroup group, BroadIndex object) {
  std::set<BroadIndex>& members = groups_[group];
  if (members.contains(object)) return false;
  for (const BroadIndex other : members) add_reason(make_broad_pair(object, other));
  return members.insert(object).second;
}

bool SpaceTimeBroadPhase::leave(BroadGroup group, BroadIndex object) {
  std::set<BroadIndex>& members = groups_[group];
  if (members.erase(object) == 0) return false;
  for (const BroadIndex other : members) drop_reason(make_broad_pair(object, other));
  return true;
}

std::span<const BroadPair> SpaceTimeBroadPhase::tick() {
  const double now_s = space_time_.now_s();
  answer_.clear();
  const auto end = std::ranges::find_if(queue_, [&](const auto& entry) { return entry.first > now_s; });
  due_.assign(queue_.begin(), end);
  queue_.erase(queue_.begin(), end);
  counters_.pairs_postponed += queue_.size();
  for (auto& [due_s, objects] : due_) {
    const Object &a = objects_[objects.low], &b = objects_[objects.high];
    Pair& pair = pairs_.at(objects);
    if (a.changed_at > pair.tested_at || b.changed_at > pair.tested_at) {
      ++counters_.box_tests;
      pair.overlaps = overlap_of(a.box, b.box);
      pair.tested_at = tick_;
    }
    due_s = kAlways_s;
    if (pair.overlaps) {
      answer_.push_back(objects);
    } else if (!a.box.is_empty() && !b.box.is_empty()) {
      due_s = earliest_overlap_s(a.box, space_time_.bound(objects.low), b.box, space_time_.bound(objects.high), now_s);
    }
    pair.due_s = due_s;
    queue_.emplace(due_s, objects);
  }
  ++tick_;
  std::ranges::sort(answer_);
  return answer_;
}

}  // namespace peerd::collision::engines
