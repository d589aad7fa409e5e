// Pairs of lanes, chosen out of eight times eight, packed into full vectors.
// For the files that Highway compiles once for each instruction set, and so is this: in each, once for each of them.
#if defined(PEERD_COLLISION_WIDE_CHOSEN_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PEERD_COLLISION_WIDE_CHOSEN_HPP
#undef PEERD_COLLISION_WIDE_CHOSEN_HPP
#else
#define PEERD_COLLISION_WIDE_CHOSEN_HPP
#endif
#include <hwy/highway.h>

#include "collision/query/wide_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace peerd::collision::HWY_NAMESPACE {

// A vector's pairs: their numbers, and the lanes of A's and of B's row that each is of.
struct ChosenLanes {
  static constexpr bool kWhole = hn::MaxLanes(Lanes()) == kWidth;  // a vector holds a row
  std::uint64_t pairs;                                             // a byte each, the first lowest
  std::uint32_t present;                                           // a bit for each that is there
};
// Takes the next pairs out of a set of them.
HWY_INLINE ChosenLanes take_lanes(std::uint64_t& set_of_pairs) {
  ChosenLanes out{0, 0};
  for (std::size_t i = 0; i < hn::Lanes(Lanes()) && set_of_pairs != 0; ++i) {
    out.pairs |= static_cast<std::uint64_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(set_of_pairs)) << (8 * i);
    out.present = 2 * out.present + 1;
    set_of_pairs &= set_of_pairs - 1;
  }
  return out;
}
HWY_INLINE std::uint8_t pair_at(const ChosenLanes& chosen, std::size_t lane) {
  return static_cast<std::uint8_t>(chosen.pairs >> (8 * lane));
}

// The numbers that a row has for A's, or for B's half of each pair.
template <bool kOfA>
class RowLookup {
 public:
  HWY_INLINE explicit RowLookup(const ChosenLanes& chosen) : chosen_(chosen) {}
  HWY_INLINE V operator()(const Row& row) const {
    if constexpr (ChosenLanes::kWhole) {
      return hn::TableLookupLanes(load(row, 0), lanes());
    } else {
      Row out;
      for (std::size_t i = 0; i < hn::Lanes(Lanes()); ++i) {
        const std::uint8_t pair = pair_at(chosen_, i);
        out[i] = row[kOfA ? LanePairs::of_a(pair) : LanePairs::of_b(pair)];
      }
      return load(out, 0);
    }
  }
  HWY_INLINE V3 operator()(const Rows& rows) const { return {(*this)(rows[0]), (*this)(rows[1]), (*this)(rows[2])}; }

 private:
  HWY_INLINE auto lanes() const {
    using Ints = hn::RebindToSigned<Lanes>;
    const auto bytes =
        hn::LoadU(hn::Rebind<std::uint8_t, Lanes>(), reinterpret_cast<const std::uint8_t*>(&chosen_.pairs));
    const auto pairs = hn::PromoteTo(Ints(), bytes);
    return hn::IndicesFromVec(Lanes(), kOfA ? hn::And(pairs, hn::Set(Ints(), 7)) : hn::ShiftRight<3>(pairs));
  }
  ChosenLanes chosen_;
};

// Appends the pairs that are in `bits` to a list.
HWY_INLINE void append(std::uint32_t bits, const ChosenLanes& chosen, LanePairs& out) {
  for (bits &= chosen.present; bits != 0; bits &= bits - 1) {
    out.at[out.count++] = pair_at(chosen, hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
  }
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
