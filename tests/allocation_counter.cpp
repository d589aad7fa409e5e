#include "tests/allocation_counter.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local long count = 0;
}

#if PEERD_COUNTS_ALLOCATIONS
// GCC sees free() of what a replaced operator new gave, and warns.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size) {
  ++count;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

long peerd::allocations() { return count; }
