#pragma once
#include <cassert>
#include <cstdint>

#include "core/mixed_bits.hpp"

namespace peerd::chaos {

// A stream of random numbers (SplitMix64; Steele, Lea and Flood 2014). Every item of a plan has a stream of its own, so
// that leaving one out changes no draw of another.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t item = 0)
      : state_(mixed_bits(seed ^ mixed_bits(stream * kStep ^ mixed_bits(item + kStep)))) {}

  [[nodiscard]] constexpr std::uint64_t next() { return mixed_bits(state_ += kStep); }
  // Below n, which is positive.
  [[nodiscard]] constexpr std::uint64_t below(std::uint64_t n) {
    assert(n > 0);
    return next() % n;
  }
  // Within [from, to).
  [[nodiscard]] constexpr double between(double from, double to) {
    assert(from <= to);
    return from + (to - from) * (static_cast<double>(next() >> 11) * 0x1.0p-53);
  }
  [[nodiscard]] constexpr bool chance(double probability) { return between(0.0, 1.0) < probability; }

 private:
  static constexpr std::uint64_t kStep = 0x9E37'79B9'7F4A'7C15;
  std::uint64_t state_;
};

}  // namespace peerd::chaos
