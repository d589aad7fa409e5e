#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace peerd {

// A slot number that stands for none.
inline constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

template <class T>
[[nodiscard]] std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// An array whose slots are used again once they are given back. A taken slot holds a T{}.
template <class T>
struct SlotPool {
  std::vector<T> items;
  std::vector<std::uint32_t> free;
  std::uint32_t take() {
    if (free.empty()) {
      assert(items.size() < kNoSlot);
      items.emplace_back();
      return static_cast<std::uint32_t>(items.size() - 1);
    }
    const std::uint32_t i = free.back();
    free.pop_back();
    items[i] = T{};
    return i;
  }
  void give_back(std::uint32_t i) { free.push_back(i); }
  [[nodiscard]] std::size_t memory_bytes() const { return capacity_bytes(items) + capacity_bytes(free); }
};

}  // namespace peerd
