#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::oracle {

struct Pair {
  Triangle a, b;
};

// xoshiro256** (Blackman, Vigna 2018) seeded by splitmix64: the same numbers on every machine and with every library.
class Rng {
 public:
  explicit Rng(std::uint64_t seed);
  std::uint64_t next();
  std::uint64_t below(std::uint64_t bound);                   // in [0, bound); bound > 0
  std::int64_t integer(std::int64_t low, std::int64_t high);  // in [low, high]
  double unit();                                              // in [0, 1), a multiple of 2^-53
  double real(double low, double high) { return low + (high - low) * unit(); }
  bool coin() { return next() >> 63; }

 private:
  std::array<std::uint64_t, 4> state_;
};

// All coordinates are finite. The names say what is promised: touch_* always touches, apart_* never; the others are
// mixed.
struct Generator {
  std::string_view name;
  Pair (*make)(Rng&);
};

// Generators of pairs as ordinary worlds have them: no care is taken that anything is special.
[[nodiscard]] std::span<const Generator> general();

// Generators of pairs that break predicates: contacts, coplanar and degenerate triangles, each also 1 ulp off and
// rounded, extreme scales.
[[nodiscard]] std::span<const Generator> adversarial();

}  // namespace peerd::oracle
