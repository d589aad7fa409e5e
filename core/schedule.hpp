#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace peerd {

// The time at which each of a number of things is to be checked. It finds those that are due by some time in the
// order of their numbers, with a tree of least times. Setting a time and finding the next one due take the logarithm
// of their number at most.
class Schedule {
 public:
  Schedule() = default;
  // No thing is ever due.
  explicit Schedule(std::size_t count) : count_(count) {
    while (leaves_ < count) leaves_ *= 2;
    least_.assign(2 * leaves_, SimTime::max());
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  // There are that many things, no fewer than before; the new ones are never due.
  void grow(std::size_t count) {
    assert(count >= count_);
    count_ = count;
    if (count <= leaves_) return;
    const std::size_t before = leaves_;
    while (leaves_ < count) leaves_ *= 2;
    std::vector<SimTime> least(2 * leaves_, SimTime::max());
    std::copy_n(least_.begin() + static_cast<std::ptrdiff_t>(before), before,
                least.begin() + static_cast<std::ptrdiff_t>(leaves_));
    for (std::size_t node = leaves_ - 1; node > 0; --node) least[node] = std::min(least[2 * node], least[2 * node + 1]);
    least_ = std::move(least);
  }
  [[nodiscard]] SimTime at(std::size_t number) const {
    assert(number < count_);
    return least_[leaves_ + number];
  }

  // Sets the time of one thing; SimTime::max(): never.
  void set(std::size_t number, SimTime t) {
    assert(number < count_);
    std::size_t node = leaves_ + number;
    least_[node] = t;
    for (; node > 1; node /= 2) {
      const SimTime least = std::min(least_[node], least_[node ^ 1]);
      if (least_[node / 2] == least) return;
      least_[node / 2] = least;
    }
  }

  // The first thing from that number on that is due at `until` or earlier; size() where none is. `until` is before
  // SimTime::max().
  [[nodiscard]] std::size_t next_due(std::size_t number, SimTime until) const {
    assert(until < SimTime::max());
    if (number >= count_) return count_;
    std::size_t node = leaves_ + number;
    while (least_[node] > until) {  // goes to the right, in ever larger steps
      while (node % 2 == 1) node /= 2;
      if (node == 0) return count_;
      ++node;
    }
    while (node < leaves_) node = least_[2 * node] <= until ? 2 * node : 2 * node + 1;
    return node - leaves_;
  }

 private:
  std::size_t count_ = 0, leaves_ = 1;
  // A binary tree: 1 is its root, the children of i are 2i and 2i + 1, the last half are the things.
  std::vector<SimTime> least_ = {SimTime::max(), SimTime::max()};
};

}  // namespace peerd
