#include "heap_meter.hpp"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace peerd::bench {
namespace {

struct Counts {
  bool on = false;
  std::ptrdiff_t live = 0, peak = 0;
  std::size_t allocations = 0;
} counts;

void* allocated(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  if (counts.on) {
    ++counts.allocations;
    counts.live += static_cast<std::ptrdiff_t>(malloc_usable_size(block));
    counts.peak = std::max(counts.peak, counts.live);
  }
  return block;
}
void release(void* block) {
  if (counts.on && block != nullptr) counts.live -= static_cast<std::ptrdiff_t>(malloc_usable_size(block));
  std::free(block);
}

}  // namespace

HeapMeter::HeapMeter() { counts = {.on = true}; }
HeapMeter::~HeapMeter() { counts.on = false; }
std::ptrdiff_t HeapMeter::live() const { return counts.live; }
std::ptrdiff_t HeapMeter::peak() const { return counts.peak; }
std::size_t HeapMeter::allocations() const { return counts.allocations; }

}  // namespace peerd::bench

// The other forms, [] and nothrow, call these.
void* operator new(std::size_t size) { return peerd::bench::allocated(std::malloc(std::max<std::size_t>(size, 1))); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return peerd::bench::allocated(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* block) noexcept { peerd::bench::release(block); }
void operator delete(void* block, std::size_t) noexcept { peerd::bench::release(block); }
void operator delete(void* block, std::align_val_t) noexcept { peerd::bench::release(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { peerd::bench::release(block); }
