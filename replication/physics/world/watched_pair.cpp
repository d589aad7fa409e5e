#include "replication/physics/world/watched_pair.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "collision/contact/contact_time.hpp"

namespace peerd::replication {
namespace {

// Contacts as near as this are of one instant: contact times are rounded down to a nanosecond.
constexpr Duration kInstant = std::chrono::nanoseconds(2);
// Normals of one pair at one instant that are told apart; more than the faces that meet in any corner of a box.
constexpr std::size_t kNormalsMax = 8;
// Normals with a cosine above this are of one face but for rounding.
constexpr double kSameNormal = 1.0 - 0x1p-40;

// A part by what does not depend on the model: a body shares its surface with its copies, and a Shape that flexes has
// none.
using PartKey = std::pair<const collision::Surface*, ObjectId>;
using PairKey = std::tuple<InterestKey, PartKey, PartKey>;

PartKey key_of_part(const WorldModel& model, std::uint32_t part) {
  if (part == ModelNode::kNone) return {nullptr, {}};
  if (model.is_flexible(part)) return {nullptr, model.flexible_part(part).shape};
  return {model.bodies[part].surface.get(), model.nodes[part].object};
}

PairKey key_of_pair(const WorldModel& model, const WatchedPair& pair) {
  return {key_of(model.pairs[pair.number]), key_of_part(model, pair.part_a), key_of_part(model, pair.part_b)};
}

}  // namespace

void WatchedPair::note_free(SimTime t) {
  if (free_at == t) return;
  std::shift_right(free_before.begin(), free_before.end(), 1);
  free_before.front() = free_at;
  free_at = t;
}

void WatchedPair::forget_free_since(SimTime from) {
  while (free_at && *free_at >= from) {
    free_at = free_before.front();
    std::shift_left(free_before.begin(), free_before.end(), 1);
    free_before.back().reset();
  }
}

void WatchedPair::remember_course(SimTime t) {
  if (past.empty() || past.back().at < t) past.push_back({t, static_cast<const PairCourse&>(*this)});
}

void WatchedPair::forget_course_before(SimTime oldest) {
  past.erase(past.begin(), std::ranges::lower_bound(past, oldest, {}, &Past::at));
  if (past.empty()) past.shrink_to_fit();
}

void WatchedPair::note_touch(SimTime t, bool is_parted) {
  assert(std::abs(normal.squaredNorm() - 1.0) < 1e-9);
  if (!met_lately(touched, t, kInstant)) at_once = 0;
  if (!met_lately(touched, t, kShortestFlight)) {
    in_burst = squeezed = 0;
    burst_from = t;
    if (!bears) normals.clear();
  }
  touched = t;
  ++at_once;
  ++in_burst;
  const auto same = std::ranges::find_if(normals, [&](const Vec3& n) { return n.dot(normal) > kSameNormal; });
  if (is_parted) {
    normals.assign(1, normal);
  } else if (same != normals.end()) {
    *same = normal;
  } else if (normals.size() < kNormalsMax) {
    normals.push_back(normal);
  } else {
    normals.front() = normal;
  }
}

void WatchedPair::rewind_course(SimTime from) {
  assert(past.empty() || past.front().at <= past.back().at);
  const auto first = std::ranges::lower_bound(past, from, {}, &Past::at);
  if (first == past.end()) return;
  static_cast<PairCourse&>(*this) = std::move(first->before);
  past.erase(first, past.end());
}

WatchedPair& WatchedPairs::add(std::uint32_t number, WatchedPair pair) {
  for (const std::uint32_t end : {pair.collider, pair.collidee}) {
    std::vector<std::uint32_t>& of = of_end_[end];
    of.insert(std::ranges::lower_bound(of, number), number);
  }
  return pairs_.add(number, std::move(pair));
}

void WatchedPairs::erase(std::uint32_t number) {
  for (const std::uint32_t end : {pairs_[number].collider, pairs_[number].collidee}) {
    std::vector<std::uint32_t>& of = of_end_[end];
    const auto at = std::ranges::lower_bound(of, number);
    assert(at != of.end() && *at == number);
    of.erase(at);
  }
  pairs_.erase(number);
}

void add_pairs(WatchedPairs& pairs, const WorldModel& model, std::uint32_t interest, SimTime start, bool watched) {
  const CollisionPair& p = model.pairs[interest];
  const auto flexes = [&](std::uint32_t part) { return model.is_flexible(part); };
  const std::uint32_t collider = model.index_of(p.collider), collidee = model.index_of(p.collidee);
  const bool is_carried =
      model.nodes[collider].carrier != ModelNode::kNone || model.nodes[collidee].carrier != ModelNode::kNone;
  const auto [first, end] = model.part_pairs_of_pair(interest);
  for (std::uint32_t i = first; i < end; ++i) {
    const PartPair& parts = model.part_pairs[i];
    const bool box = p.type == CollisionType::kBox, whole = parts.a == ModelNode::kNone;
    const bool flexible = whole ? std::ranges::any_of(model.parts_of_node[collider], flexes) ||
                                      std::ranges::any_of(model.parts_of_node[collidee], flexes)
                                : flexes(parts.a) || flexes(parts.b);
    WatchedPair pair{};
    pair.collider = collider;
    pair.collidee = collidee;
    pair.part_a = parts.a;
    pair.part_b = parts.b;
    pair.common = parts.common;
    pair.number = interest;
    pair.type = p.type;
    pair.fixed = parts.fixed;
    pair.is_plain = parts.a == collider && parts.b == collidee && !is_carried;
    pair.is_flexible = flexible;
    pair.collider_responds = model.answers(p, p.collider);
    pair.collidee_responds = model.answers(p, p.collidee);
    pair.has_exact_search =
        box || flexible || collision::has_exact_answer(model.bodies[parts.a], model.bodies[parts.b]);
    pair.watched = watched;
    pair.clear_until = start;
    pairs.add(i, std::move(pair));
  }
}

namespace {

// Whether an object is the same end in both models: with the same body, and answering contacts alike.
bool is_same_end(const WorldModel& before, const WorldModel& next, std::uint32_t node) {
  const ObjectId id = next.nodes[node].object;
  if (!before.scene->contains(id) || before.node(id) == nullptr) return false;
  const std::uint32_t was = before.index_of(id);
  const CollisionResponse *const answered = before.response_of(id), *const answers = next.response_of(id);
  const bool same_answer = answered != nullptr && answers != nullptr ? *answered == *answers : answered == answers;
  return same_answer && before.bodies[was].surface == next.bodies[node].surface &&
         before.nodes[was].carrier == ModelNode::kNone && next.nodes[node].carrier == ModelNode::kNone &&
         before.parts_of_node[was].size() == 1 && next.parts_of_node[node].size() == 1;
}

// The pairs of `next` that may have to be there: all listed ones, and of those of groups the ones that were there
// before and those of members that are new, other than before, or not in the group before.
std::vector<std::uint32_t> pairs_in_question(const WorldModel& before, const WatchedPairs& known,
                                             const WorldModel& next) {
  std::vector<std::uint32_t> numbers;
  next.pairs.for_each_listed([&](std::uint32_t number, const CollisionPair&) { numbers.push_back(number); });
  for (const std::uint32_t i : known.numbers()) {
    const CollisionPair pair = before.pairs[known[i].number];
    if (!next.scene->contains(pair.collider) || !next.scene->contains(pair.collidee)) continue;
    for (const std::uint32_t number : next.pairs_between(pair.collider, pair.collidee)) {
      if (next.pairs[number].type == pair.type) numbers.push_back(number);
    }
  }
  for (const PairGroup& group : next.groups) {
    const PairGroup* was = nullptr;
    const auto member_before = [&](const PairGroup::Member& member) -> const PairGroup::Member* {
      const ObjectId id = next.nodes[member.node].object;
      if (!before.scene->contains(id) || before.node(id) == nullptr) return nullptr;
      const std::uint32_t node = before.index_of(id);
      for (const PairNumbers::Stretch& stretch : before.node_pairs.stretches_of(node)) {
        if (stretch.group == nullptr || stretch.group->type() != group.type()) continue;
        if (was == nullptr) was = stretch.group;
        if (stretch.group == was) return was->member(node);
      }
      return nullptr;
    };
    for (const PairGroup::Member& member : group.members()) {
      const PairGroup::Member* const as = member_before(member);
      const bool is_same = as != nullptr && (as->row == kNoNode) == (member.row == kNoNode) &&
                           (as->column == kNoNode) == (member.column == kNoNode) &&
                           is_same_end(before, next, member.node);
      if (is_same) continue;
      for (std::uint32_t k = 0; k < group.count_of(member); ++k) {
        numbers.push_back(group.first() + group.offset_of(member, k));
      }
    }
  }
  std::ranges::sort(numbers);
  numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
  assert(numbers.empty() || numbers.back() < next.pairs.size());
  return numbers;
}

}  // namespace

std::vector<std::uint32_t> carry_over(const WorldModel& before, WatchedPairs known, const WorldModel& next,
                                      SimTime start, const IsWatched& is_watched, WatchedPairs& pairs) {
  assert(known.size() == before.part_pairs.size() && pairs.size() == next.part_pairs.size());
  std::map<PairKey, WatchedPair*> same;
  std::map<std::uint32_t, bool> was_inside;  // by number, before: of those of which a pair is there, whether one was
  for (const std::uint32_t i : known.numbers()) {
    WatchedPair& pair = known[i];
    was_inside[pair.number] |= pair.inside;
    same.emplace(key_of_pair(before, pair), &pair);
  }
  std::vector<std::uint32_t> added;
  for (const std::uint32_t number : pairs_in_question(before, known, next)) {
    const CollisionPair ends = next.pairs[number];
    const auto number_before = before.number_of(key_of(ends));
    const auto inside = number_before ? was_inside.find(*number_before) : was_inside.end();
    if (inside == was_inside.end()) {
      const bool was_far = number_before && is_same_end(before, next, next.index_of(ends.collider)) &&
                           is_same_end(before, next, next.index_of(ends.collidee));
      if (was_far || (is_watched != nullptr && !is_watched(ends))) continue;
    }
    add_pairs(pairs, next, number, start, is_watched == nullptr || is_watched(ends));
    const auto [first, end] = next.part_pairs_of_pair(number);
    for (std::uint32_t i = first; i < end; ++i) {
      WatchedPair& pair = pairs[i];
      const auto at = same.find(key_of_pair(next, pair));
      const auto is_same = [&](const WatchedPair& other) {
        return other.fixed == pair.fixed && other.collider_responds == pair.collider_responds &&
               other.collidee_responds == pair.collidee_responds;
      };
      if (at == same.end() || !is_same(*at->second)) {
        if (inside != was_inside.end()) pair.inside = inside->second && !pair.fixed;
        added.push_back(i);
        continue;
      }
      const WatchedPair fresh = std::exchange(pair, std::move(*at->second));
      pair.collider = fresh.collider;
      pair.collidee = fresh.collidee;
      pair.part_a = fresh.part_a;
      pair.part_b = fresh.part_b;
      pair.common = fresh.common;
      pair.number = fresh.number;
      pair.fixed = fresh.fixed;
      pair.is_plain = fresh.is_plain;
      pair.is_scheduled = false;
      pair.is_far = false;
    }
  }
  return added;
}

}  // namespace peerd::replication
