#include "collision/broad_phase/sweep_and_prune.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace peerd::collision {

void SweepAndPrune::insert(BroadIndex object) {
  for (Axis& axis : axes_) {
    if (axis.place.size() < 2 * std::size_t{object} + 2) axis.place.resize(2 * std::size_t{object} + 2, kNone);
    assert(axis.place[2 * object] == kNone);
  }
}

void SweepAndPrune::erase(BroadIndex object) {
  if (axes_[0].place[2 * object] != kNone) take_out(object);
}

void SweepAndPrune::take_out(BroadIndex object) {
  for (Axis& axis : axes_) {
    std::uint32_t kept = axis.place[2 * object];
    for (std::uint32_t i = kept; i < axis.ends.size(); ++i) {
      if (axis.ends[i].object() == object) continue;
      axis.place[axis.ends[i].who] = kept;
      axis.ends[kept++] = axis.ends[i];
    }
    axis.ends.resize(kept);
    axis.place[2 * object] = axis.place[2 * object + 1] = kNone;
  }
}

void SweepAndPrune::update(std::span<const BroadIndex> changed, std::vector<Found>& found) {
  std::size_t added = 0;
  for (const BroadIndex object : changed) {
    const bool is_there = axes_[0].place[2 * object] != kNone;
    if (boxes_[object].is_none()) {
      if (is_there) take_out(object);
    } else if (!is_there) {
      ++added;
    }
  }
  // Walking in from the end takes as many steps as there are ends.
  const bool many = added > 16 && added > axes_[0].ends.size() / 64;
  if (many) return sort_anew(changed, found);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const BroadIndex object : changed) {
    if (boxes_[object].is_none()) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      Axis& axis = axes_[i];
      if (axis.place[2 * object] == kNone) {
        for (const std::uint32_t who : {2 * object, 2 * object + 1}) {
          axis.place[who] = static_cast<std::uint32_t>(axis.ends.size());
          axis.ends.push_back({infinity, who});
        }
      }
      // The end in front goes first, so that a box is never inside out.
      const std::uint32_t lower = 2 * object, upper = lower + 1;
      const bool upwards = boxes_[object].lo[i] > axis.ends[axis.place[lower]].at_m;
      if (upwards) walk(axis, upper, boxes_[object].hi[i], found);
      walk(axis, lower, boxes_[object].lo[i], found);
      if (!upwards) walk(axis, upper, boxes_[object].hi[i], found);
    }
  }
}

void SweepAndPrune::walk(Axis& axis, std::uint32_t who, float to_m, std::vector<Found>& found) {
  const End end{to_m, who};
  auto& ends = axis.ends;
  std::uint32_t at = axis.place[who];
  const auto shift = [&](std::uint32_t from) {
    ends[at] = ends[from];
    axis.place[ends[at].who] = at;
    at = from;
  };
  const auto meet = [&](const End& other) {  // an upper end and a lower one have changed places, to overlap
    ++box_tests_;
    if (overlap(boxes_[end.object()], boxes_[other.object()])) found.push_back({end.object(), other.object()});
  };
  while (at > 0 && end.before(ends[at - 1])) {
    if (!end.upper() && ends[at - 1].upper() && ends[at - 1].object() != end.object()) meet(ends[at - 1]);
    shift(at - 1);
  }
  while (at + 1 < ends.size() && ends[at + 1].before(end)) {
    if (end.upper() && !ends[at + 1].upper() && ends[at + 1].object() != end.object()) meet(ends[at + 1]);
    shift(at + 1);
  }
  ends[at] = end;
  axis.place[who] = at;
}

void SweepAndPrune::sort_anew(std::span<const BroadIndex> changed, std::vector<Found>& found) {
  for (std::size_t i = 0; i < 3; ++i) {
    Axis& axis = axes_[i];
    for (const BroadIndex object : changed) {
      if (boxes_[object].is_none() || axis.place[2 * object] != kNone) continue;
      axis.ends.push_back({0.0F, 2 * object});
      axis.ends.push_back({0.0F, 2 * object + 1});
    }
    for (End& end : axis.ends) end.at_m = end.upper() ? boxes_[end.object()].hi[i] : boxes_[end.object()].lo[i];
    std::ranges::sort(axis.ends, [](const End& a, const End& b) {
      return a.before(b) || (!b.before(a) && a.who < b.who);  // the order of equals is written down, too
    });
    for (std::uint32_t k = 0; k < axis.ends.size(); ++k) axis.place[axis.ends[k].who] = k;
  }
  open_.clear();
  for (const End& end : axes_[0].ends) {
    if (end.upper()) {
      *std::ranges::find(open_, end.object()) = open_.back();
      open_.pop_back();
      continue;
    }
    for (const BroadIndex other : open_) {
      ++box_tests_;
      if (overlap(boxes_[end.object()], boxes_[other])) found.push_back({end.object(), other});
    }
    open_.push_back(end.object());
  }
}

}  // namespace peerd::collision
