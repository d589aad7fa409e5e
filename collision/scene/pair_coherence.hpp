#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "collision/scene/scene_query.hpp"

namespace peerd::collision {

// Tests whether pairs of Shapes touch, tick after tick. The leaves where two Shapes touched are tested first, eight
// polygons against eight: the crossing of two surfaces mostly is still there, or beside it. The answer doesn't depend
// on the cache.
class PairCoherence {
 public:
  // These count pairs of Shapes whose boxes overlap, each once a tick.
  struct Counters {
    std::uint64_t pairs_witnessed = 0;  // pairs that still touch in the leaves where they did
    std::uint64_t pairs_tested = 0;     // pairs tested from the roots of their trees
  };

  // Without `caches`, all pairs are tested.
  explicit PairCoherence(bool caches) : caches_(caches) {}

  // `tick` never decreases; a pair that was tested in this tick costs nothing. `hint` is kept by the caller for the
  // pair; any number will do, and the pair's own is fastest.
  [[nodiscard]] bool touch(const SceneQuery::ClosePair& pair, std::uint64_t tick, std::uint32_t& hint);

  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] const QueryCounters& query_counters() const { return query_.counters(); }

 private:
  struct CachedPair {
    std::uint64_t key = 0;                       // both instances, a << 32 | b
    std::uint64_t version_a = 0, version_b = 0;  // 0: none yet
    std::uint64_t tested_at_tick = 0;            // the tick of the last test
    WideQuery::LeafPair leaf_pair{};             // the leaves where they touch
    bool touching = false;
  };
  [[nodiscard]] CachedPair& find(std::uint64_t key, std::uint64_t tick, std::uint32_t& hint);
  void evict_old(std::uint64_t tick);

  bool caches_;
  std::vector<CachedPair> cache_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_of_key_;  // the index in cache_, by key
  std::size_t eviction_size_ = 4096;                               // the size of cache_ at which old pairs are evicted
  WideQuery query_;
  Counters counters_;
};

}  // namespace peerd::collision
