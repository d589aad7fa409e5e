#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/math.hpp"
#include "replication/wire/varint.hpp"

namespace peerd::baselines {

// A vector in whole steps along each axis, as messages have it.
using Steps = std::array<std::int32_t, 3>;

// The nearest steps of that size, within +-2^30.
[[nodiscard]] inline Steps in_steps(const Vec3& value, double step) {
  constexpr double kMost = 1 << 30;
  Steps steps{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double exact = std::clamp(value[static_cast<Eigen::Index>(i)] / step, -kMost, kMost);
    steps[i] = static_cast<std::int32_t>(std::lround(exact));
  }
  return steps;
}
[[nodiscard]] inline Vec3 from_steps(const Steps& steps, double step) {
  return step * Vec3(steps[0], steps[1], steps[2]);
}

// A whole number of either sign, such that small ones are short (Protobuf's ZigZag).
inline void put_signed(replication::BitWriter& out, std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  replication::put_varint(out, (bits << 1) ^ (value < 0 ? ~std::uint32_t{0} : 0));
}
[[nodiscard]] inline bool take_signed(replication::BitReader& in, std::int32_t& value) {
  std::uint32_t zigzag = 0;
  if (!replication::take_varint(in, zigzag)) return false;
  value = static_cast<std::int32_t>((zigzag >> 1) ^ ((zigzag & 1) == 0 ? 0 : ~std::uint32_t{0}));
  return true;
}

}  // namespace peerd::baselines
