#pragma once
#include <cassert>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/wire/bit_stream.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {

// Varints are whole numbers in the form of Protobuf: 7 bits a byte, the lowest first, and 1 in the eighth if more
// follow. Each number has one form, the shortest; take_..() returns whether it has read that.

inline void put_varint(BitWriter& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out.put((value & 127) | 128, 8);
  out.put(value, 8);
}

template <class Number>
[[nodiscard]] bool take_varint(BitReader& in, Number& value) {
  static_assert(std::unsigned_integral<Number>);
  std::uint64_t wide = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint64_t group = in.get(8);
    if (shift == 63 && group > 1) return false;
    wide |= (group & 127) << shift;
    if (group >= 128) continue;
    if (shift > 0 && group == 0) return false;
    if (wide > std::numeric_limits<Number>::max()) return false;
    value = static_cast<Number>(wide);
    return true;
  }
  return false;
}

// The id of an object; one of the world's file is its number.
inline void put_object(BitWriter& out, ObjectId id) { put_varint(out, id.packed()); }
[[nodiscard]] inline bool take_object(BitReader& in, ObjectId& id) {
  std::uint64_t packed = 0;
  if (!take_varint(in, packed)) return false;
  id = ObjectId::unpacked(packed);
  return true;
}

// A time as its difference from another one, modulo 2^64, which is its own inverse; small differences of either sign
// are short.
inline void put_time(BitWriter& out, SimTime from, SimTime t) {
  const auto d = static_cast<std::uint64_t>(t.time_since_epoch().count()) -
                 static_cast<std::uint64_t>(from.time_since_epoch().count());
  put_varint(out, (d << 1) ^ (d >> 63 == 0 ? 0 : ~std::uint64_t{0}));
}
[[nodiscard]] inline bool take_time(BitReader& in, SimTime from, SimTime& t) {
  std::uint64_t zigzag = 0;
  if (!take_varint(in, zigzag)) return false;
  const std::uint64_t d = (zigzag >> 1) ^ ((zigzag & 1) == 0 ? 0 : ~std::uint64_t{0});
  t = SimTime{Duration{static_cast<std::int64_t>(static_cast<std::uint64_t>(from.time_since_epoch().count()) + d)}};
  return in_range(t.time_since_epoch().count());
}

// The lowest five bytes of a time: 18 minutes, of which the receiver's own time says which.
inline constexpr int kLowTime_bits = 40;
[[nodiscard]] inline std::uint64_t low_time(SimTime t) {
  return static_cast<std::uint64_t>(t.time_since_epoch().count()) & ((std::uint64_t{1} << kLowTime_bits) - 1);
}
// The time with those low bits that is nearest to `near`.
[[nodiscard]] inline bool take_low_time(std::uint64_t low, SimTime near, SimTime& t) {
  assert(low >> kLowTime_bits == 0);
  constexpr int kAbove_bits = 64 - kLowTime_bits;
  const auto here = static_cast<std::uint64_t>(near.time_since_epoch().count());
  // Shifted up and down again, the difference's highest bit that travels is its sign.
  const std::int64_t ahead = static_cast<std::int64_t>((low - here) << kAbove_bits) >> kAbove_bits;
  const auto ns = static_cast<std::int64_t>(here + static_cast<std::uint64_t>(ahead));
  t = SimTime{Duration{ns}};
  return in_range(ns);
}

}  // namespace peerd::replication
