#pragma once
#include <cstddef>

namespace peerd::bench {

// Counts the calls of operator new, which heap_meter.cpp replaces, while one is alive. For one thread, and one at a
// time. Costs a branch per allocation where none is alive.
class HeapMeter {
 public:
  HeapMeter();
  ~HeapMeter();
  HeapMeter(const HeapMeter&) = delete;
  HeapMeter& operator=(const HeapMeter&) = delete;

  [[nodiscard]] std::size_t allocations() const;
};

}  // namespace peerd::bench
