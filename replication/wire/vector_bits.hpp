#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

#include "core/math.hpp"
#include "replication/wire/bit_stream.hpp"

namespace peerd::replication {

// Vectors and orientations, bit for bit, in the form that records and decisions share; proto/README.md specifies the
// bits. Each take_..() returns whether its put_..() could have made the bits, so that every value has one form.

inline bool is_identity(const Quat& q) { return q.coeffs() == Quat::Identity().coeffs(); }

// Writes, where an axis is zero, a mask of the axes that are not. Returns the mask.
template <class Three>
unsigned put_mask(BitWriter& out, const Three& axes) {
  unsigned mask = 0;
  for (unsigned i = 0; i < 3; ++i) mask |= (axes[i] != 0 ? 1u : 0u) << i;
  out.put(mask == 7 ? 0 : 1, 1);
  if (mask != 7) out.put(mask, 3);
  return mask;
}

[[nodiscard]] inline bool take_mask(BitReader& in, bool may_be_empty, unsigned& mask) {
  mask = 7;
  if (in.get(1) == 0) return true;
  mask = static_cast<unsigned>(in.get(3));
  return mask != 7 && (mask != 0 || may_be_empty);
}

inline void put_exact(BitWriter& out, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  out.put(bits & 0xFFFF'FFFF, 32);
  out.put(bits >> 32, 32);
}
inline void put_exact(BitWriter& out, const Vec3& v) {
  const auto bits = std::bit_cast<std::array<std::uint64_t, 3>>(std::array{v.x(), v.y(), v.z()});
  const bool absent = bits == std::array<std::uint64_t, 3>{};
  out.put(absent ? 0 : 1, 1);
  if (absent) return;
  const unsigned mask = put_mask(out, bits);
  for (int i = 0; i < 3; ++i) {
    if ((mask >> i & 1) != 0) put_exact(out, v[i]);
  }
}

// Writes an orientation that is not the identity; the identity is not sent.
inline void put_exact(BitWriter& out, const Quat& q) {
  assert(!is_identity(q));
  for (const double component : {q.w(), q.x(), q.y(), q.z()}) put_exact(out, component);
}

[[nodiscard]] inline double take_exact(BitReader& in) {
  const std::uint64_t low = in.get(32);
  return std::bit_cast<double>(in.get(32) << 32 | low);
}
[[nodiscard]] inline bool take_exact(BitReader& in, Vec3& v) {
  unsigned mask = 0;
  if (in.get(1) == 0) return true;
  if (!take_mask(in, false, mask)) return false;
  for (int i = 0; i < 3; ++i) {
    if ((mask >> i & 1) == 0) continue;
    v[i] = take_exact(in);
    if (std::bit_cast<std::uint64_t>(v[i]) == 0) return false;
  }
  return true;
}

[[nodiscard]] inline bool take_exact(BitReader& in, Quat& q) {
  std::array<double, 4> components{};
  for (double& component : components) component = take_exact(in);
  q = Quat(components[0], components[1], components[2], components[3]);
  return !is_identity(q);
}

}  // namespace peerd::replication
