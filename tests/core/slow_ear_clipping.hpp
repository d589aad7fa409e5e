#pragma once
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/ear_clipping.hpp"

namespace peerd::testing_support {

// SlowEarClipping is the twin that EarClipping is compared with. It follows the same rule with all corners sorted by x
// in place of a tree: a search goes through those of the range of x of the triangle. It is quadratic where many corners
// have one range of x.
class SlowEarClipping {
 public:
  void cut(std::span<const PlanePoint> points, std::vector<CornerTriangle>& triangles);

 private:
  enum class Kind : std::uint8_t { kSpike, kEar, kBlocked, kOther, kCut };
  struct Corner {
    std::uint32_t previous = 0, next = 0;                    // neighbours in the polygon that is left
    std::uint32_t previous_distinct = 0, next_distinct = 0;  // nearest corners of the whole polygon at another point
    std::uint32_t blocker = 0;                               // place in by_x_; all before it don't block
    std::uint32_t first_waiting = kNone;                     // entry of waiting_ for who is blocked by this corner
    Kind kind = Kind::kOther;
  };
  struct Waiting {
    std::uint32_t corner, next_entry;
  };
  static constexpr std::uint32_t kNone = 0xffff'ffff;

  void link();
  void classify(std::uint32_t i);
  void find_blocker(std::uint32_t i);
  [[nodiscard]] bool blocks(std::uint32_t i, std::uint32_t j) const;
  void remove(std::uint32_t i);
  void push_candidate(Kind kind, std::uint32_t i);
  [[nodiscard]] std::uint32_t take_next();

  std::span<const PlanePoint> points_;
  // The arrays are kept from call to call for their memory.
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> by_x_;        // corners sorted by x
  std::vector<Waiting> waiting_;           // lists
  std::vector<std::uint64_t> candidates_;  // heap of spikes and ears, the best on top; some are stale
  std::uint32_t lowest_ = 0;               // no corner below it is left
};

// Returns, for three points of a line, whether b is inside the segment from a to c.
inline bool between(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (lexicographically_less(a, b) && lexicographically_less(b, c)) ||
         (lexicographically_less(c, b) && lexicographically_less(b, a));
}

inline void SlowEarClipping::cut(std::span<const PlanePoint> points, std::vector<CornerTriangle>& triangles) {
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

inline void SlowEarClipping::link() {
  const auto count = static_cast<std::uint32_t>(points_.size());
  corners_.assign(count, {});
  waiting_.clear();
  candidates_.clear();
  lowest_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    corners_[i].previous = i == 0 ? count - 1 : i - 1;
    corners_[i].next = i + 1 == count ? 0 : i + 1;
  }
  // The loop goes around twice: the neighbour of the first corner may be behind many equal ones. Where all are equal
  // they stay 0.
  for (std::uint32_t step = 0; step < 2 * count; ++step) {
    const std::uint32_t i = step % count, before_i = corners_[i].previous;
    const bool distinct = points_[before_i] != points_[i];
    corners_[i].previous_distinct = distinct ? before_i : corners_[before_i].previous_distinct;
    const std::uint32_t j = count - 1 - i, after_j = corners_[j].next;
    corners_[j].next_distinct = points_[after_j] != points_[j] ? after_j : corners_[after_j].next_distinct;
  }
  by_x_.resize(count);
  std::iota(by_x_.begin(), by_x_.end(), 0U);
  std::ranges::sort(by_x_, {}, [&](std::uint32_t i) { return std::pair(points_[i].x, i); });
}

inline void SlowEarClipping::classify(std::uint32_t i) {
  Corner& corner = corners_[i];
  const PlanePoint &a = points_[corner.previous], &b = points_[i], &c = points_[corner.next];
  const int t = orient2d(a, b, c);
  if (t > 0) {
    const auto first =
        std::ranges::lower_bound(by_x_, std::min({a.x, b.x, c.x}), {}, [&](std::uint32_t j) { return points_[j].x; });
    corner.blocker = static_cast<std::uint32_t>(first - by_x_.begin());
    find_blocker(i);
  } else if (t == 0 && !between(a, b, c)) {
    push_candidate(Kind::kSpike, i);
  } else {
    corner.kind = Kind::kOther;
  }
}

// The search goes on where it stopped: corners only disappear, and blocks() is about points that don't move.
inline void SlowEarClipping::find_blocker(std::uint32_t i) {
  Corner& corner = corners_[i];
  const PlanePoint &a = points_[corner.previous], &b = points_[i], &c = points_[corner.next];
  const auto [y_min, y_max] = std::minmax({a.y, b.y, c.y});
  const float x_max = std::max({a.x, b.x, c.x});
  for (; corner.blocker < by_x_.size(); ++corner.blocker) {
    const std::uint32_t j = by_x_[corner.blocker];
    if (points_[j].x > x_max) break;
    if (points_[j].y < y_min || points_[j].y > y_max || corners_[j].kind == Kind::kCut) continue;
    if (j == i || j == corner.previous || j == corner.next || !blocks(i, j)) continue;
    corner.kind = Kind::kBlocked;
    waiting_.push_back({i, corners_[j].first_waiting});
    corners_[j].first_waiting = static_cast<std::uint32_t>(waiting_.size() - 1);
    return;
  }
  push_candidate(Kind::kEar, i);
}

// Returns whether corner j keeps triangle a b c from being cut off. A corner inside the triangle or on its new edge
// does. A corner on the edges a b and b c of the polygon, or at b, does only if one of its own edges leads inside:
// otherwise it touches from outside, as corners at a seam do. At a or c an edge that leads inside either ends there,
// which the test of that end finds, or crosses the polygon.
inline bool SlowEarClipping::blocks(std::uint32_t i, std::uint32_t j) const {
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

inline void SlowEarClipping::remove(std::uint32_t i) {
  const std::uint32_t previous = corners_[i].previous, next = corners_[i].next;
  corners_[i].kind = Kind::kCut;
  corners_[previous].next = next;
  corners_[next].previous = previous;
  classify(previous);
  classify(next);
  for (std::uint32_t entry = corners_[i].first_waiting; entry != kNone; entry = waiting_[entry].next_entry) {
    const std::uint32_t waiting = waiting_[entry].corner;  // or it did once
    if (corners_[waiting].kind == Kind::kBlocked && by_x_[corners_[waiting].blocker] == i) find_blocker(waiting);
  }
}

inline void SlowEarClipping::push_candidate(Kind kind, std::uint32_t i) {
  corners_[i].kind = kind;
  candidates_.push_back(std::uint64_t{kind == Kind::kEar} << 32 | i);
  std::ranges::push_heap(candidates_, std::greater());
}

inline std::uint32_t SlowEarClipping::take_next() {
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

}  // namespace peerd::testing_support
