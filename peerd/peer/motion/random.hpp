#pragma once
#include <cmath>
#include <cstdint>

#include "core/mixed_bits.hpp"

namespace peerd::motion {

// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014). It gives the same
// numbers with every library, which std::'s distributions do not promise.
class Random {
 public:
  // Objects that share a seed draw from different sequences, by their number `n`.
  Random(std::uint64_t seed, std::uint64_t n) : state_(seed) { state_ = bits() ^ (n * 0xD1B54A32D192ED03u); }

  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15u;
    return mixed_bits(state_);
  }
  // A number in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double from, double to) { return from + (to - from) * uniform(); }
  // A number of mean 0 and variance 1: the sum of twelve uniform ones, so never beyond 6, and without libm.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  bool chance(double probability) { return uniform() < probability; }
  // An integer from 0 to count - 1.
  std::uint64_t below(std::uint64_t count) { return bits() % count; }

 private:
  std::uint64_t state_;
};

// One step of an Ornstein-Uhlenbeck process of mean 0 (exact in distribution), with the standard deviation `sd` in the
// long run and the time constant `memory_s`.
inline double wander(double value, double sd, double memory_s, double step_s, Random& random) {
  const double kept = std::exp(-step_s / memory_s);
  return kept * value + sd * std::sqrt(1.0 - kept * kept) * random.normal();
}

}  // namespace peerd::motion
