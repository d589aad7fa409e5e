#include "collision/baselines/space_time.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/baselines/volume_tree.hpp"

namespace peerd::collision::baselines {
namespace {

// A pair that is due at each tick.
constexpr double kAlways_s = -std::numeric_limits<double>::infinity();

bool overlap_or_empty(const WorldBox& a, const WorldBox& b, bool& is_empty) {
  is_empty = a.is_empty() || b.is_empty();
  for (int i = 0; i < 3 && !is_empty; ++i) {
    if (!(a.lo[i] <= b.hi[i] && b.lo[i] <= a.hi[i])) return false;
  }
  return !is_empty;
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
  const double room_m = kRounding * (largest_coordinate(a) + largest_coordinate(b));
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
  if (boxes_.size() <= object) boxes_.resize(object + 1);
  boxes_[object] = box;
}

void SpaceTimeBroadPhase::remove(BroadIndex object) {
  assert(object < boxes_.size());
  for (auto pair = pairs_.begin(); pair != pairs_.end();) {
    const auto next = std::next(pair);
    if (pair->first.low == object || pair->first.high == object) erase(pair);
    pair = next;
  }
  for (auto& [number, group] : groups_) group.erase(object);
}

void SpaceTimeBroadPhase::move(BroadIndex object, const WorldBox& box) {
  assert(object < boxes_.size());
  if (boxes_[object] == box) return;
  boxes_[object] = box;
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
  for (auto& [due_s, pair] : due_) {
    const WorldBox &a = boxes_[pair.low], &b = boxes_[pair.high];
    ++counters_.box_tests;
    bool is_empty = false;
    due_s = kAlways_s;
    if (overlap_or_empty(a, b, is_empty)) {
      answer_.push_back(pair);
    } else if (!is_empty) {
      due_s = earliest_overlap_s(a, space_time_.bound(pair.low), b, space_time_.bound(pair.high), now_s);
    }
    pairs_.at(pair).due_s = due_s;
    queue_.emplace(due_s, pair);
  }
  std::ranges::sort(answer_);
  return answer_;
}

}  // namespace peerd::collision::baselines
