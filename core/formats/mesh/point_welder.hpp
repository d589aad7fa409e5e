#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "core/mixed_bits.hpp"

namespace peerd::formats {

// A PointWelder gives each place one index, for formats that write a point once for each polygon around it. Places are
// equal bit for bit, but that -0 is 0. They are in a table by a hash. A place whose slots are taken, as a hostile file
// can arrange for all of its places, goes into a tree: a search costs no more than the logarithm of their number.
class PointWelder {
 public:
  // Returns the index of the point at the end of `points`, which is taken off again where the place is known.
  [[nodiscard]] std::int32_t weld(std::vector<float>& points) {
    const auto index = static_cast<std::int32_t>(points.size() / 3 - 1);
    if (2 * points.size() / 3 > slots_.size()) grow(points, index);
    const std::int32_t known = find_or_add(points, index);
    if (known != index) points.resize(points.size() - 3);
    return known;
  }

 private:
  using Place = std::array<std::uint32_t, 3>;  // the bits of the coordinates
  static constexpr std::int32_t kFree = -1;
  static constexpr std::size_t kProbes = 32;  // slots of a place, one behind the other

  static Place at(const std::vector<float>& points, std::int32_t index) {
    const float* const first = points.data() + 3 * static_cast<std::size_t>(index);
    Place place{};
    for (std::size_t i = 0; i < 3; ++i) place[i] = std::bit_cast<std::uint32_t>(first[i] + 0.0F);
    return place;
  }

  // Returns the index of the place that a point has; it is the point's own where the place is new.
  std::int32_t find_or_add(const std::vector<float>& points, std::int32_t index) {
    const Place place = at(points, index);
    const std::uint64_t hash = mixed_bits(mixed_bits(place[0] | std::uint64_t{place[1]} << 32) ^ place[2]);
    for (std::size_t probe = 0; probe < kProbes; ++probe) {
      std::int32_t& slot = slots_[(hash + probe) & (slots_.size() - 1)];
      if (slot == kFree) return slot = index;
      if (at(points, slot) == place) return slot;
    }
    return crowded_.try_emplace(place, index).first->second;
  }

  // Doubles the table, and enters the points before `index` again.
  void grow(const std::vector<float>& points, std::int32_t index) {
    slots_.assign(std::max(2 * kProbes, 2 * slots_.size()), kFree);
    crowded_.clear();
    for (std::int32_t i = 0; i < index; ++i) find_or_add(points, i);
  }

  std::vector<std::int32_t> slots_;  // a power of two; indices of points, at least half of them free
  std::map<Place, std::int32_t> crowded_;
};

}  // namespace peerd::formats
