#include "collision/scene/pair_coherence.hpp"

#include <algorithm>

namespace peerd::collision {

bool PairCoherence::touch(const SceneQuery::ClosePair& pair, std::uint64_t tick, std::uint32_t& hint) {
  Memory& memory = find(std::uint64_t{pair.a} << 32 | pair.b, tick, hint);
  const bool same = memory.form_a == pair.form_a && memory.form_b == pair.form_b;
  if (same && memory.asked_at == tick) return memory.touching;
  memory.asked_at = tick;
  if (same && remembers_ && memory.touching &&
      query_.touch_near(*pair.tree_a, *pair.tree_b, pair.a_from_b, memory.spot)) {
    ++counters_.pairs_witnessed;
    return true;
  }
  memory.form_a = pair.form_a;
  memory.form_b = pair.form_b;
  ++counters_.pairs_tested;
  PolygonPair found{};
  memory.touching = query_.find_pair(*pair.tree_a, *pair.tree_b, pair.a_from_b, found, &memory.spot);
  return memory.touching;
}

PairCoherence::Memory& PairCoherence::find(std::uint64_t key, std::uint64_t tick, std::uint32_t& hint) {
  if (hint < memories_.size() && memories_[hint].key == key) return memories_[hint];
  if (memories_.size() >= room_) forget_old(tick);
  const auto [place, is_new] = places_.try_emplace(key, static_cast<std::uint32_t>(memories_.size()));
  if (is_new) memories_.push_back({.key = key});
  hint = place->second;
  return memories_[hint];
}

// Those that nobody has asked about for a while: that costs a test more if somebody does.
void PairCoherence::forget_old(std::uint64_t tick) {
  constexpr std::uint64_t kForgotten = 64;  // ticks
  std::erase_if(memories_, [&](const Memory& memory) { return memory.asked_at + kForgotten < tick; });
  places_.clear();
  for (std::uint32_t i = 0; i < memories_.size(); ++i) places_.emplace(memories_[i].key, i);
  room_ = std::max<std::size_t>(4096, 2 * memories_.size());
}

}  // namespace peerd::collision
