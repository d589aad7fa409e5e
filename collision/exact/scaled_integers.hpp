#pragma once
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

namespace peerd::collision {

// Binary64 numbers as integers, times a common power of two: what exact arithmetic falls back on where exponents leave
// the range of expansions.
class ScaledIntegers {
 public:
  using Int = boost::multiprecision::cpp_int;

  ScaledIntegers(std::initializer_list<double> numbers) {
    for (const double x : numbers) {
      int exponent = 0;
      if (std::frexp(x, &exponent) != 0.0) least_ = std::min(least_, exponent);
    }
  }
  [[nodiscard]] Int operator()(double x) const {
    int exponent = 0;
    const double significand = std::frexp(x, &exponent);
    if (significand == 0.0) return 0;
    return Int(static_cast<std::int64_t>(std::ldexp(significand, 53))) << (exponent - least_);
  }
  // The integer 1 stands for 2 to the power of this; 0 where all numbers are 0.
  [[nodiscard]] int exponent() const { return least_ == kNone ? 0 : least_ - 53; }

 private:
  static constexpr int kNone = std::numeric_limits<int>::max();
  int least_ = kNone;
};

}  // namespace peerd::collision
