#pragma once
#include <array>
#include <cassert>
#include <cstdint>
#include <vector>

#include "collision/broad_phase/broad_pair.hpp"

namespace peerd::collision {

// Pairs of objects worth a test, in one flat array without holes and, through links in the pairs, by object. Adding and
// erasing are O(1), and take memory only where there have never been so many.
class NearPairs {
 public:
  using Index = std::uint32_t;
  static constexpr Index kNone = ~0u;

  struct Pair {
    std::array<BroadIndex, 2> object;  // the lower one first
    std::array<Index, 2> next, previous;
    bool overlapping = false;  // whether the exact boxes overlapped at the last tick

    [[nodiscard]] std::size_t side(BroadIndex o) const { return object[1] == o ? 1 : 0; }
    [[nodiscard]] BroadIndex other(BroadIndex o) const { return object[1] == o ? object[0] : object[1]; }
    [[nodiscard]] BroadPair pair() const { return {object[0], object[1]}; }
  };

  void grow(std::size_t objects) {
    if (first_.size() < objects) first_.resize(objects, kNone);
  }
  void reserve(std::size_t pairs) { pairs_.reserve(pairs); }
  [[nodiscard]] std::vector<Pair>& all() { return pairs_; }
  [[nodiscard]] Pair& operator[](Index i) { return pairs_[i]; }
  [[nodiscard]] Index first(BroadIndex object) const { return first_[object]; }
  [[nodiscard]] Index next(Index i, BroadIndex object) const { return pairs_[i].next[pairs_[i].side(object)]; }

  [[nodiscard]] Index find(BroadIndex a, BroadIndex b) const {
    assert(a != b && a < first_.size() && b < first_.size());
    Index i = first_[a];
    while (i != kNone && pairs_[i].other(a) != b) i = next(i, a);
    return i;
  }
  void add(BroadPair pair) {
    assert(pair.low < pair.high && pairs_.size() < kNone);
    assert(pair.high < first_.size());
    const auto i = static_cast<Index>(pairs_.size());
    Pair& added = pairs_.emplace_back();
    added.object = {pair.low, pair.high};
    for (std::size_t s = 0; s < 2; ++s) {
      Index& first = first_[added.object[s]];
      added.next[s] = first;
      added.previous[s] = kNone;
      if (first != kNone) pairs_[first].previous[pairs_[first].side(added.object[s])] = i;
      first = i;
    }
  }
  // The last pair takes the place of the erased one.
  void erase(Index i) {
    assert(i < pairs_.size());
    for (std::size_t s = 0; s < 2; ++s) {
      const Pair& p = pairs_[i];
      link(p.object[s], p.previous[s], p.next[s]);
    }
    const auto last = static_cast<Index>(pairs_.size() - 1);
    if (i != last) {
      pairs_[i] = pairs_[last];
      for (std::size_t s = 0; s < 2; ++s) {
        const Pair& p = pairs_[i];
        link(p.object[s], p.previous[s], i);
        link(p.object[s], i, p.next[s]);
      }
    }
    pairs_.pop_back();
  }

 private:
  // Makes `next` the successor of `previous` in the list of an object; kNone stands for the ends.
  void link(BroadIndex object, Index previous, Index next) {
    assert(object < first_.size() && (next == kNone || next < pairs_.size()));
    if (previous == kNone) {
      first_[object] = next;
    } else {
      pairs_[previous].next[pairs_[previous].side(object)] = next;
    }
    if (next != kNone) pairs_[next].previous[pairs_[next].side(object)] = previous;
  }
  std::vector<Pair> pairs_;
  std::vector<Index> first_;  // by object: its first pair, or kNone
};

}  // namespace peerd::collision
