#pragma once
#include <cassert>

namespace peerd::net {

// The entry behind that key, going round: so all keys of a map, which is not empty, take turns.
template <class Map>
[[nodiscard]] typename Map::iterator next_after(Map& map, const typename Map::key_type& key) {
  assert(!map.empty());
  const auto next = map.upper_bound(key);
  return next == map.end() ? map.begin() : next;
}

}  // namespace peerd::net
