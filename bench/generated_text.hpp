#pragma once
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>

namespace peerd::bench {

// Its own numbers from bits: the standard's distributions differ from one library to the next.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double real(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits_() % n); }

 private:
  std::mt19937_64 bits_;
};

// printf to the end of `out`; a line of at most 511 bytes.
[[gnu::format(printf, 2, 3)]] inline void append(std::string& out, const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  const int size = std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  out.append(line, static_cast<std::size_t>(size));
}

}  // namespace peerd::bench
