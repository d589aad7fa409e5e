// Pairs of lanes, chosen out of eight times eight, packed into full vectors; pairs of oriented boxes among them.
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

// Oriented boxes, one to a lane.
struct OrientedBoxes {
  V3 center, half;
  V3 axes[3];  // the first axis of each box, the second, the third
};

// The oriented boxes of B's children in A's frame; their half sides stay as they are.
struct MovedBoxes {
  Rows center;
  std::array<Rows, 3> axes;
  Rows lo, hi;  // the axis-aligned boxes of A's frame around them, wider by the slack
};
HWY_INLINE V3 absolute(const V3& v) { return {hn::Abs(v.x), hn::Abs(v.y), hn::Abs(v.z)}; }
HWY_INLINE void move_boxes(const WideTree::Node& b, const WideMotion& m, MovedBoxes& out) {
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(Lanes())) {
    const V3 center = plus(times(m.a_from_b, load3(b.oriented_center, i)), m.b_in_a);
    store3(center, out.center, i);
    const V3 half = load3(b.oriented_half, i);
    V3 x = times(m.a_from_b, load3(b.axes[0], i)), y = times(m.a_from_b, load3(b.axes[1], i)),
       z = times(m.a_from_b, load3(b.axes[2], i));
    store3(x, out.axes[0], i), store3(y, out.axes[1], i), store3(z, out.axes[2], i);
    x = absolute(x), y = absolute(y), z = absolute(z);
    const V slack = set(m.slack_oriented);
    const auto reach = [&](V of_x, V of_y, V of_z) { return hn::Add(dot({of_x, of_y, of_z}, half), slack); };
    const V3 around{reach(x.x, y.x, z.x), reach(x.y, y.y, z.y), reach(x.z, y.z, z.z)};
    store3(minus(center, around), out.lo, i);
    store3({hn::Add(center.x, around.x), hn::Add(center.y, around.y), hn::Add(center.z, around.z)}, out.hi, i);
  }
}

// Pairs of boxes have these along the fifteen separating axes of Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996:
// the three of A, the three of B, and the cross products of one of either, whose length is 1 at most.
struct SeparatingAxes {
  V ha[3], hb[3];         // half the sides of either box
  V t[3];                 // the vector from A's center to B's, by its components along A's axes
  V c[3][3], size[3][3];  // the dot products of an axis of A and one of B, and their absolute values

  HWY_INLINE SeparatingAxes(const OrientedBoxes& a, const OrientedBoxes& b) {
    const V3 a_to_b = minus(b.center, a.center);
    ha[0] = a.half.x, ha[1] = a.half.y, ha[2] = a.half.z;
    hb[0] = b.half.x, hb[1] = b.half.y, hb[2] = b.half.z;
    set_row<0>(a, b, a_to_b), set_row<1>(a, b, a_to_b), set_row<2>(a, b, a_to_b);
  }
  // How far both boxes together reach along A's axis i, along B's axis j, and along the cross product of the two.
  template <std::size_t i>
  HWY_INLINE V reach_along_a() const {
    return hn::Add(dot({size[i][0], size[i][1], size[i][2]}, {hb[0], hb[1], hb[2]}), ha[i]);
  }
  template <std::size_t j>
  HWY_INLINE V reach_along_b() const {
    return hn::Add(dot({size[0][j], size[1][j], size[2][j]}, {ha[0], ha[1], ha[2]}), hb[j]);
  }
  template <std::size_t i, std::size_t j>
  HWY_INLINE V reach_along_product() const {
    constexpr std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return hn::Add(hn::Add(hn::Mul(ha[i1], size[i2][j]), hn::Mul(ha[i2], size[i1][j])),
                   hn::Add(hn::Mul(hb[j1], size[i][j2]), hn::Mul(hb[j2], size[i][j1])));
  }
  // The component along B's axis j, and along the product of A's axis i and it, of a vector with the components v along
  // A's axes.
  template <std::size_t j>
  HWY_INLINE V along_b(const V (&v)[3]) const {
    return dot({c[0][j], c[1][j], c[2][j]}, {v[0], v[1], v[2]});
  }
  template <std::size_t i, std::size_t j>
  HWY_INLINE V along_product(const V (&v)[3]) const {
    constexpr std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    return hn::Sub(hn::Mul(v[i2], c[i1][j]), hn::Mul(v[i1], c[i2][j]));
  }

 private:
  template <std::size_t i>
  HWY_INLINE void set_row(const OrientedBoxes& a, const OrientedBoxes& b, const V3& a_to_b) {
    t[i] = dot(a.axes[i], a_to_b);
    c[i][0] = dot(a.axes[i], b.axes[0]), c[i][1] = dot(a.axes[i], b.axes[1]), c[i][2] = dot(a.axes[i], b.axes[2]);
    size[i][0] = hn::Abs(c[i][0]), size[i][1] = hn::Abs(c[i][1]), size[i][2] = hn::Abs(c[i][2]);
  }
};

// The boxes of the chosen pairs, out of those of a node's children.
template <bool kOfA>
HWY_INLINE OrientedBoxes chosen_boxes(const Rows& center, const Rows& half, const std::array<Rows, 3>& axes,
                                      const RowLookup<kOfA>& chosen) {
  return {chosen(center), chosen(half), {chosen(axes[0]), chosen(axes[1]), chosen(axes[2])}};
}

}  // namespace peerd::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
