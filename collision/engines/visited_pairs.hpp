#pragma once
#include <algorithm>
#include <vector>

#include "collision/query/tree_query.hpp"

namespace peerd::collision::engines {

// The answers of a NarrowPhase, by a search that visits pairs of polygons that touch, in any order and some of them
// more than once: `search(found)` calls found(pair) until that returns true, and returns whether it did.

template <class Search>
[[nodiscard]] bool first_visited(Search search, PolygonPair& pair) {
  return search([&](const PolygonPair& found) {
    pair = found;
    return true;
  });
}

// All pairs, sorted, each once.
template <class Search>
[[nodiscard]] std::vector<PolygonPair> all_visited(Search search) {
  std::vector<PolygonPair> pairs;
  (void)search([&](const PolygonPair& found) {
    pairs.push_back(found);
    return false;
  });
  std::ranges::sort(pairs);
  const auto rest = std::ranges::unique(pairs);
  pairs.erase(rest.begin(), rest.end());
  return pairs;
}

}  // namespace peerd::collision::engines
