#include "collision/broad_phase/sweep_and_prune.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace peerd::collision {

void SweepAndPrune::insert(BroadIndex object) {
  for (Axis& axis : axes_) {
    if (axis.position_of.size() < 2 * std::size_t{object} + 2)
      axis.position_of.resize(2 * std::size_t{object} + 2, kNone);
    assert(axis.position_of[2 * object] == kNone);
  }
}

void SweepAndPrune::erase(BroadIndex object) {
  if (axes_[0].position_of[2 * object] != kNone) remove_endpoints(object);
}

void SweepAndPrune::remove_endpoints(BroadIndex object) {
  for (Axis& axis : axes_) {
    std::uint32_t kept = axis.position_of[2 * object];
    for (std::uint32_t i = kept; i < axis.endpoints.size(); ++i) {
      if (axis.endpoints[i].object() == object) continue;
      axis.position_of[axis.endpoints[i].endpoint_id] = kept;
      axis.endpoints[kept++] = axis.endpoints[i];
    }
    axis.endpoints.resize(kept);
    axis.position_of[2 * object] = axis.position_of[2 * object + 1] = kNone;
  }
}

void SweepAndPrune::update(std::span<const BroadIndex> changed, std::vector<Found>& found) {
  std::size_t added = 0;
  for (const BroadIndex object : changed) {
    const bool is_there = axes_[0].position_of[2 * object] != kNone;
    if (boxes_[object].is_none()) {
      if (is_there) remove_endpoints(object);
    } else if (!is_there) {
      ++added;
    }
  }
  // Walking in from the end takes as many steps as there are ends.
  const bool many = added > 16 && added > axes_[0].endpoints.size() / 64;
  if (many) return sort_all(changed, found);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const BroadIndex object : changed) {
    if (boxes_[object].is_none()) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      Axis& axis = axes_[i];
      if (axis.position_of[2 * object] == kNone) {
        for (const std::uint32_t endpoint_id : {2 * object, 2 * object + 1}) {
          axis.position_of[endpoint_id] = static_cast<std::uint32_t>(axis.endpoints.size());
          axis.endpoints.push_back({infinity, endpoint_id});
        }
      }
      // The end in front goes first, so that a box is never inside out.
      const std::uint32_t lower = 2 * object, upper = lower + 1;
      const bool upwards = boxes_[object].lo[i] > axis.endpoints[axis.position_of[lower]].at_m;
      if (upwards) move_endpoint(axis, upper, boxes_[object].hi[i], found);
      move_endpoint(axis, lower, boxes_[object].lo[i], found);
      if (!upwards) move_endpoint(axis, upper, boxes_[object].hi[i], found);
    }
  }
}

void SweepAndPrune::move_endpoint(Axis& axis, std::uint32_t endpoint_id, float to_m, std::vector<Found>& found) {
  const Endpoint end{to_m, endpoint_id};
  auto& endpoints = axis.endpoints;
  std::uint32_t at = axis.position_of[endpoint_id];
  const auto shift = [&](std::uint32_t from) {
    endpoints[at] = endpoints[from];
    axis.position_of[endpoints[at].endpoint_id] = at;
    at = from;
  };
  const auto meet = [&](const Endpoint& other) {  // an upper end and a lower one have changed places, to overlap
    ++box_tests_;
    if (overlap(boxes_[end.object()], boxes_[other.object()])) found.push_back({end.object(), other.object()});
  };
  while (at > 0 && end.before(endpoints[at - 1])) {
    if (!end.upper() && endpoints[at - 1].upper() && endpoints[at - 1].object() != end.object())
      meet(endpoints[at - 1]);
    shift(at - 1);
  }
  while (at + 1 < endpoints.size() && endpoints[at + 1].before(end)) {
    if (end.upper() && !endpoints[at + 1].upper() && endpoints[at + 1].object() != end.object())
      meet(endpoints[at + 1]);
    shift(at + 1);
  }
  endpoints[at] = end;
  axis.position_of[endpoint_id] = at;
}

void SweepAndPrune::sort_all(std::span<const BroadIndex> changed, std::vector<Found>& found) {
  for (std::size_t i = 0; i < 3; ++i) {
    Axis& axis = axes_[i];
    for (const BroadIndex object : changed) {
      if (boxes_[object].is_none() || axis.position_of[2 * object] != kNone) continue;
      axis.endpoints.push_back({0.0F, 2 * object});
      axis.endpoints.push_back({0.0F, 2 * object + 1});
    }
    for (Endpoint& end : axis.endpoints)
      end.at_m = end.upper() ? boxes_[end.object()].hi[i] : boxes_[end.object()].lo[i];
    std::ranges::sort(axis.endpoints, [](const Endpoint& a, const Endpoint& b) {
      return a.before(b) ||
             (!b.before(a) && a.endpoint_id < b.endpoint_id);  // the order of equals is written down, too
    });
    for (std::uint32_t k = 0; k < axis.endpoints.size(); ++k) axis.position_of[axis.endpoints[k].endpoint_id] = k;
  }
  open_.clear();
  for (const Endpoint& end : axes_[0].endpoints) {
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
