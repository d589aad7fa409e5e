#pragma once
#include <cstddef>

namespace peerd::bench {

// Counts what this program has from operator new, which heap_meter.cpp replaces, while one is alive; in bytes as the
// allocator rounds them up. For one thread, and one at a time. Costs a branch per allocation where none is alive.
class HeapMeter {
 public:
  HeapMeter();
  ~HeapMeter();
  HeapMeter(const HeapMeter&) = delete;
  HeapMeter& operator=(const HeapMeter&) = delete;

  [[nodiscard]] std::ptrdiff_t live() const;  // since it was made; below 0 where older blocks were freed
  [[nodiscard]] std::ptrdiff_t peak() const;  // of live()
  [[nodiscard]] std::size_t allocations() const;
};

}  // namespace peerd::bench
