#include "collision/scene/pair_coherence.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::collision {

bool PairCoherence::touch(const SceneQuery::ClosePair& pair, std::uint64_t tick, std::uint32_t& hint) {
  assert(pair.a < pair.b && pair.tree_a != nullptr && pair.tree_b != nullptr);
  CachedPair& cached = find(std::uint64_t{pair.a} << 32 | pair.b, tick, hint);
  assert(pair.version_a > 0 && pair.version_b > 0 && cached.tested_at_tick <= tick);
  const bool same = cached.version_a == pair.version_a && cached.version_b == pair.version_b;
  if (same && cached.tested_at_tick == tick) return cached.touching;
  cached.tested_at_tick = tick;
  if (same && caches_ && cached.touching &&
      query_.touch_near_leaves(*pair.tree_a, *pair.tree_b, pair.a_from_b, cached.leaf_pair)) {
    ++counters_.pairs_witnessed;
    return true;
  }
  cached.version_a = pair.version_a;
  cached.version_b = pair.version_b;
  ++counters_.pairs_tested;
  PolygonPair found{};
  cached.touching = query_.find_pair(*pair.tree_a, *pair.tree_b, pair.a_from_b, found, &cached.leaf_pair);
  return cached.touching;
}

PairCoherence::CachedPair& PairCoherence::find(std::uint64_t key, std::uint64_t tick, std::uint32_t& hint) {
  if (hint < cache_.size() && cache_[hint].key == key) return cache_[hint];
  if (cache_.size() >= eviction_size_) evict_old(tick);
  const auto [place, is_new] = index_of_key_.try_emplace(key, static_cast<std::uint32_t>(cache_.size()));
  if (is_new) cache_.push_back({.key = key});
  hint = place->second;
  assert(cache_[hint].key == key);
  return cache_[hint];
}

// Evicts pairs that no caller has asked about for a while; such a pair costs a test more if a caller does.
void PairCoherence::evict_old(std::uint64_t tick) {
  constexpr std::uint64_t kEvictionAge = 64;  // ticks
  std::erase_if(cache_, [&](const CachedPair& cached) { return cached.tested_at_tick + kEvictionAge < tick; });
  index_of_key_.clear();
  for (std::uint32_t i = 0; i < cache_.size(); ++i) index_of_key_.emplace(cache_[i].key, i);
  assert(index_of_key_.size() == cache_.size());
  eviction_size_ = std::max<std::size_t>(4096, 2 * cache_.size());
}

}  // namespace peerd::collision
