#pragma once
#include <cstddef>

namespace peerd {

// Asks for memory early, for code that goes through much of it and knows what comes next. The address need not be
// valid. A function that calls this one must inline it always, too: GCC drops calls of functions that do nothing but
// this.
[[gnu::always_inline]] inline void prefetch(const void* begin, std::size_t size_bytes) {
  constexpr std::size_t kCacheLine_bytes = 64;
  const auto* const bytes = static_cast<const std::byte*>(begin);
  for (std::size_t i = 0; i < size_bytes; i += kCacheLine_bytes) __builtin_prefetch(bytes + i);
  __builtin_prefetch(bytes + size_bytes - 1);  // the last line, where the first is not begun at its begin
}

template <class T>
[[gnu::always_inline]] inline void prefetch(const T& what) {
  prefetch(&what, sizeof what);
}

}  // namespace peerd
