#pragma once
#include "replication/physics/world/watched_pair.hpp"

namespace peerd::replication::test {

// All part pairs of the model, watched from `start` on.
inline WatchedPairs all_watched(const WorldModel& model, SimTime start) {
  WatchedPairs pairs(model);
  for (std::uint32_t number = 0; number < model.pairs.size(); ++number) add_pairs(pairs, model, number, start, true);
  return pairs;
}

}  // namespace peerd::replication::test
