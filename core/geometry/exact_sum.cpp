#include "core/geometry/exact_sum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace peerd {
namespace {
constexpr std::uint64_t kDigitMask = 0xffff'ffff;
}  // namespace

// A call moves each digit by less than 2^33, so that 2^30 calls fit.
void ExactSum::add(double product) {
  if (product == 0.0) return;
  const auto bits = std::bit_cast<std::uint64_t>(product);
  const std::uint64_t significand = (bits & 0xf'ffff'ffff'ffff) | 0x10'0000'0000'0000;
  const auto shift = static_cast<std::uint32_t>(static_cast<int>((bits >> 52) & 0x7ff) - 1075 - kLeastExponent);
  const std::uint64_t low = (significand & kDigitMask) << (shift % 32);
  const std::uint64_t high = (significand >> 32) << (shift % 32);
  const std::int64_t sign = product < 0.0 ? -1 : 1;
  std::int64_t* digit = &digits_[shift / 32];
  digit[0] += sign * static_cast<std::int64_t>(low & kDigitMask);
  digit[1] += sign * static_cast<std::int64_t>((low >> 32) + (high & kDigitMask));
  digit[2] += sign * static_cast<std::int64_t>(high >> 32);
}

std::int64_t ExactSum::carry(std::array<std::int64_t, kDigits>& digits) {
  std::int64_t carried = 0;
  for (std::int64_t& digit : digits) {
    digit += carried;
    carried = digit >> 32;  // rounds down
    digit &= kDigitMask;
  }
  return carried;
}

int ExactSum::sign() const {
  auto digits = digits_;
  if (carry(digits) < 0) return -1;
  return std::ranges::all_of(digits, [](std::int64_t digit) { return digit == 0; }) ? 0 : 1;
}

double ExactSum::value() const {
  const int s = sign();
  auto digits = digits_;
  for (std::int64_t& digit : digits) digit *= s;
  carry(digits);
  // The first digit that isn't zero and the two behind it hold at least 65 bits.
  int top = kDigits - 1;
  while (top > 2 && digits[static_cast<std::size_t>(top)] == 0) --top;
  double sum = 0.0;
  for (int i = top; i > top - 3; --i) sum = sum * 0x1p32 + static_cast<double>(digits[static_cast<std::size_t>(i)]);
  return s * std::ldexp(sum, 32 * (top - 2) + kLeastExponent);
}

}  // namespace peerd
