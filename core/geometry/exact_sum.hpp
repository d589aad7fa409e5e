#pragma once
#include <array>
#include <cstdint>

namespace peerd {

// An ExactSum is a sum of products of two finite binary32 numbers without any rounding, whatever their sizes and order.
// It decides signs that a floating-point filter cannot. At most 2^30 products.
class ExactSum {
 public:
  // The product of two binary32 numbers is exact in binary64, and never subnormal.
  void add(float a, float b) { add(static_cast<double>(a) * static_cast<double>(b)); }
  void subtract(float a, float b) { add(-(static_cast<double>(a) * static_cast<double>(b))); }

  [[nodiscard]] int sign() const;      // -1, 0 or 1
  [[nodiscard]] double value() const;  // relative error below 2^-52, so the sign is right; exact where 53 bits suffice

 private:
  static constexpr int kDigits = 21;
  static constexpr int kLeastExponent = -352;  // digit i counts 2^(32 i - 352); all products are multiples of 2^-298

  void add(double product);
  // Carries until every digit is within [0, 2^32). The carry out of the last digit is -1 if the sum is negative.
  static std::int64_t carry(std::array<std::int64_t, kDigits>& digits);

  std::array<std::int64_t, kDigits> digits_{};  // digits of either sign, and not carried yet
};

}  // namespace peerd
