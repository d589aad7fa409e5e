#include "heap_meter.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace peerd::bench {
namespace {

struct Counts {
  bool on = false;
  std::size_t allocations = 0;
} counts;

void* allocated(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  if (counts.on) ++counts.allocations;
  return block;
}

}  // namespace

HeapMeter::HeapMeter() { counts = {.on = true}; }
HeapMeter::~HeapMeter() { counts.on = false; }
std::size_t HeapMeter::allocations() const { return counts.allocations; }

}  // namespace peerd::bench

// The other forms, [] and nothrow, call these.
void* operator new(std::size_t size) { return peerd::bench::allocated(std::malloc(std::max<std::size_t>(size, 1))); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return peerd::bench::allocated(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
