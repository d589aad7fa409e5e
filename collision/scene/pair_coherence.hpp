#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "collision/scene/scene_query.hpp"

namespace peerd::collision {

// Whether pairs of Shapes touch, tick after tick. Where they did they are tested first, eight polygons against eight:
// the crossing of two surfaces mostly is still there, or beside it. The answer doesn't depend on what is remembered.
class PairCoherence {
 public:
  // Pairs of Shapes whose boxes overlap, each counted once a tick.
  struct Counters {
    std::uint64_t pairs_witnessed = 0;  // where they touched they still do
    std::uint64_t pairs_tested = 0;     // from the roots of their trees
  };

  // Without `caches`, all pairs are tested.
  explicit PairCoherence(bool caches) : caches_(caches) {}

  // `tick` grows; asked again in one tick, a pair costs nothing. `hint`: the caller's, of this pair most likely; any
  // number will do.
  [[nodiscard]] bool touch(const SceneQuery::ClosePair& pair, std::uint64_t tick, std::uint32_t& hint);

  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] const QueryCounters& query_counters() const { return query_.counters(); }

 private:
  struct CachedPair {
    std::uint64_t key = 0;                       // both instances
    std::uint64_t version_a = 0, version_b = 0;  // 0: of nothing
    std::uint64_t tested_at_tick = 0;            // the last tick
    WideQuery::LeafPair leaf_pair{};             // where they touch
    bool touching = false;
  };
  [[nodiscard]] CachedPair& find(std::uint64_t key, std::uint64_t tick, std::uint32_t& hint);
  void evict_old(std::uint64_t tick);

  bool caches_;
  std::vector<CachedPair> cache_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_of_key_;  // in memories_, by key
  std::size_t eviction_size_ = 4096;                               // of memories, before old ones are looked for
  WideQuery query_;
  Counters counters_;
};

}  // namespace peerd::collision
