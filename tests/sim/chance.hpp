#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <random>

namespace peerd::sim::testing_support {

// Seeded draws for generated worlds: the same on every machine, for the standard fixes this engine's numbers.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  // Uniform in [0, n), up to a bias below n / 2^64.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool happens(double probability) { return between(0.0, 1.0) < probability; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(values.size())];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace peerd::sim::testing_support
