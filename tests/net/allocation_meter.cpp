#include "tests/net/allocation_meter.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace peerd::net::testing_support {
namespace {

thread_local std::size_t count = 0;

void* allocated(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  ++count;
  return block;
}

}  // namespace

std::size_t allocations() { return count; }

}  // namespace peerd::net::testing_support

// The library's array and nothrow forms call these. Those of a sanitizer do not, so the nothrow form is replaced, too.
void* operator new(std::size_t size) {
  return peerd::net::testing_support::allocated(std::malloc(std::max<std::size_t>(size, 1)));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return peerd::net::testing_support::allocated(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }
