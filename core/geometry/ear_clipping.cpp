#include "core/geometry/ear_clipping.hpp"

#include <algorithm>
#include <cassert>
#include <functional>

namespace peerd {
namespace {

// Returns, for three points of a line, whether b is inside the segment from a to c.
bool between(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (lexicographically_less(a, b) && lexicographically_less(b, c)) ||
         (lexicographically_less(c, b) && lexicographically_less(b, a));
}

}  // namespace

void EarClipping::cut(std::span<const PlanePoint> points, std::vector<CornerTriangle>& triangles) {
  assert(points.size() >= 3);
  points_ = points;
  link();
  const auto count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < count; ++i) classify(i);
  for (std::uint32_t left = count; left > 3; --left) {
    const std::uint32_t i = take_next();
    triangles.push_back({corners_[i].previous, i, corners_[i].next});
    remove(i);
  }
  while (corners_[lowest_].kind == Kind::kCut) ++lowest_;
  triangles.push_back({lowest_, corners_[lowest_].next, corners_[lowest_].previous});
}

void EarClipping::link() {
  const auto count = static_cast<std::uint32_t>(points_.size());
  corners_.assign(count, {});
  blocked_corners_.clear();
  candidates_.clear();
  lowest_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    corners_[i].previous = i == 0 ? count - 1 : i - 1;
    corners_[i].next = i + 1 == count ? 0 : i + 1;
  }
  // Twice around: the first corner's neighbour may be behind many equal ones. Where all are equal they stay 0.
  for (std::uint32_t step = 0; step < 2 * count; ++step) {
    const std::uint32_t i = step % count, before_i = corners_[i].previous;
    const bool distinct = points_[before_i] != points_[i];
    corners_[i].previous_distinct = distinct ? before_i : corners_[before_i].previous_distinct;
    const std::uint32_t j = count - 1 - i, after_j = corners_[j].next;
    corners_[j].next_distinct = points_[after_j] != points_[j] ? after_j : corners_[after_j].next_distinct;
  }
  tree_.build(points_);
}

void EarClipping::classify(std::uint32_t i) {
  Corner& corner = corners_[i];
  const PlanePoint &a = points_[corner.previous], &b = points_[i], &c = points_[corner.next];
  const int t = orient2d(a, b, c);
  if (t > 0) {
    corner.searched_until = 0;
    find_blocker(i);
  } else if (t == 0 && !between(a, b, c)) {
    push_candidate(Kind::kSpike, i);
  } else {
    corner.kind = Kind::kOther;
  }
}

// Goes on where it stopped: corners only disappear, and blocks() is about points that don't move. The one that blocked
// last mostly blocks the next triangle too.
void EarClipping::find_blocker(std::uint32_t i) {
  Corner& corner = corners_[i];
  const PlanePoint &a = points_[corner.previous], &b = points_[i], &c = points_[corner.next];
  const auto is_blocker = [&](std::uint32_t j) {
    return j != i && j != corner.previous && j != corner.next && blocks(i, j);
  };
  corner.kind = Kind::kBlocked;
  if (corner.blocker != kNone && corners_[corner.blocker].kind != Kind::kCut && is_blocker(corner.blocker)) return;
  corner.searched_until = tree_.find(corner.searched_until, a, b, c, is_blocker);
  if (corner.searched_until == tree_.size()) return push_candidate(Kind::kEar, i);
  corner.blocker = tree_.corner_at(corner.searched_until);
  blocked_corners_.push_back({i, corners_[corner.blocker].first_blocked});
  corners_[corner.blocker].first_blocked = static_cast<std::uint32_t>(blocked_corners_.size() - 1);
}

// Does corner j keep triangle a b c from being cut off? Inside it and on the new edge, yes. On the polygon's own edges
// a b and b c, and at b, only if one of its edges leads inside: else it touches from outside, as corners at a seam do.
// At a or c an edge that leads inside either ends there, which that end tells, or crosses the polygon.
bool EarClipping::blocks(std::uint32_t i, std::uint32_t j) const {
  const PlanePoint &a = points_[corners_[i].previous], &b = points_[i], &c = points_[corners_[i].next];
  const PlanePoint& p = points_[j];
  if (p == a || p == c) return false;
  const int ab = orient2d(a, b, p), bc = orient2d(b, c, p);
  if (ab < 0 || bc < 0 || orient2d(c, a, p) < 0) return false;
  const auto leads_inside = [&](const PlanePoint& q) {
    return (ab > 0 || orient2d(a, b, q) > 0) && (bc > 0 || orient2d(b, c, q) > 0);
  };
  return leads_inside(points_[corners_[j].previous_distinct]) || leads_inside(points_[corners_[j].next_distinct]);
}

void EarClipping::remove(std::uint32_t i) {
  const std::uint32_t previous = corners_[i].previous, next = corners_[i].next;
  corners_[i].kind = Kind::kCut;
  tree_.remove(i);
  corners_[previous].next = next;
  corners_[next].previous = previous;
  classify(previous);
  classify(next);
  for (std::uint32_t entry = corners_[i].first_blocked; entry != kNone; entry = blocked_corners_[entry].next_entry) {
    const std::uint32_t waiting = blocked_corners_[entry].corner;  // or it did once
    const Corner& corner = corners_[waiting];
    if (corner.kind == Kind::kBlocked && corner.blocker == i) find_blocker(waiting);
  }
}

void EarClipping::push_candidate(Kind kind, std::uint32_t i) {
  corners_[i].kind = kind;
  candidates_.push_back(std::uint64_t{kind == Kind::kEar} << 32 | i);
  std::ranges::push_heap(candidates_, std::greater());
}

std::uint32_t EarClipping::take_next() {
  while (!candidates_.empty()) {
    std::ranges::pop_heap(candidates_, std::greater());
    const std::uint64_t best = candidates_.back();
    candidates_.pop_back();
    const auto i = static_cast<std::uint32_t>(best);
    if (corners_[i].kind == (best >> 32 != 0 ? Kind::kEar : Kind::kSpike)) return i;
  }
  while (corners_[lowest_].kind == Kind::kCut) ++lowest_;
  return lowest_;
}

}  // namespace peerd
