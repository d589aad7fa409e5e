#include "collision/engines/i_collide.hpp"

#include <algorithm>
#include <numeric>

#include "collision/engines/visited_pairs.hpp"
#include "collision/engines/volume_tree.hpp"
#include "collision/exact/triangle_pair.hpp"

namespace peerd::collision::engines {
namespace {

bool boxes_touch(const WorldBox& a, const WorldBox& b) {
  for (int k = 0; k < 3; ++k) {
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
  }
  return true;
}

WorldBox box_of_triangle(const Triangle& triangle) {
  WorldBox box;
  for (const Vec3& corner : triangle) box.merge(corner);
  return box;
}

int longest_axis(const WorldBox& box) {
  int axis = 0;
  (box.hi - box.lo).maxCoeff(&axis);
  return axis;
}

}  // namespace

const ICollide::Object& ICollide::object(const NumberedSoup& of) {
  const auto [at, is_new] = objects_.try_emplace(of.number);
  Object& kept = at->second;
  if (!is_new) return kept;
  kept.pieces = convex_pieces(*of.soup);
  for (const SoupPiece& piece : kept.pieces) {
    WorldBox& box = kept.boxes.emplace_back();
    for (const std::uint32_t vertex : piece.vertices) box.merge(of.soup->vertices[vertex]);
  }
  return kept;
}

void ICollide::place(const TriangleSoup& b, const Object& of_b, const RelativeMotion& a_from_b) {
  moved_.clear();
  for (const Vec3& vertex : b.vertices) moved_.push_back(a_from_b(vertex));
  boxes_b_.clear();
  box_b_ = {};
  for (const SoupPiece& piece : of_b.pieces) {
    WorldBox& box = boxes_b_.emplace_back();
    for (const std::uint32_t vertex : piece.vertices) box.merge(moved_[vertex]);
    box_b_.merge(box);
    ++counters_.bv_updates;
  }
}

// Insertion sort, which costs little where little has changed; from the beginning where much has.
void ICollide::sort(std::vector<std::uint32_t>& order, const Object& a, int axis) {
  const std::size_t count_a = a.boxes.size(), count = count_a + boxes_b_.size();
  const auto low = [&](std::uint32_t i) { return (i < count_a ? a.boxes[i] : boxes_b_[i - count_a]).lo[axis]; };
  const auto before = [&](std::uint32_t i, std::uint32_t j) { return low(i) < low(j) || (low(i) == low(j) && i < j); };
  std::uint64_t left = 4 * count;
  bool is_sorted = order.size() == count;
  for (std::size_t i = 1; is_sorted && i < count; ++i) {
    for (std::size_t j = i; j > 0 && before(order[j], order[j - 1]); --j) {
      std::swap(order[j], order[j - 1]);
      ++sort_moves_;
      if (left-- == 0) {
        is_sorted = false;
        break;
      }
    }
  }
  if (is_sorted) return;
  order.resize(count);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, before);
  sort_moves_ += count;
}

// Leaves in memory.near the pairs of pieces whose boxes overlap, with the features that they had the last time.
void ICollide::sweep(Memory& memory, const Object& a, const WorldBox& box_a) {
  const int axis = longest_axis(box_a);
  sort(memory.order, a, axis);
  const auto count_a = static_cast<std::uint32_t>(a.boxes.size());
  std::vector<std::uint32_t> open_a, open_b;
  std::vector<PiecePair> found;
  const auto meet = [&](std::vector<std::uint32_t>& open, const std::vector<WorldBox>& boxes, const WorldBox& box,
                        auto pair_with) {
    std::size_t kept = 0;
    for (const std::uint32_t other : open) {
      if (boxes[other].hi[axis] < box.lo[axis]) continue;  // the sweep has left it
      open[kept++] = other;
      ++counters_.bv_tests;
      if (boxes_touch(boxes[other], box)) found.push_back(pair_with(other));
    }
    open.resize(kept);
  };
  for (const std::uint32_t i : memory.order) {
    const bool is_of_a = i < count_a;
    const std::uint32_t piece = is_of_a ? i : i - count_a;
    const WorldBox& box = is_of_a ? a.boxes[piece] : boxes_b_[piece];
    if (!boxes_touch(box, is_of_a ? box_b_ : box_a)) continue;
    if (is_of_a) {
      meet(open_b, boxes_b_, box, [&](std::uint32_t other) { return PiecePair{piece, other}; });
      open_a.push_back(piece);
    } else {
      meet(open_a, a.boxes, box, [&](std::uint32_t other) { return PiecePair{other, piece}; });
      open_b.push_back(piece);
    }
  }
  std::ranges::sort(found);
  std::vector<Near> near;
  auto last = memory.near.begin();
  for (const PiecePair& pieces : found) {
    last = std::ranges::find_if(last, memory.near.end(), [&](const Near& old) { return old.pieces >= pieces; });
    const bool is_known = last != memory.near.end() && last->pieces == pieces;
    near.push_back(is_known ? *last : Near{pieces, {}});
  }
  memory.near = std::move(near);
}

// Visits the polygons of two pieces whose triangles touch until `found` returns true, and returns whether it did.
template <class Found>
bool ICollide::touch_pieces(const TriangleSoup& a, const TriangleSoup& b, const SoupPiece& of_a, const SoupPiece& of_b,
                            Found found) {
  const auto moved = [&](std::uint32_t face) {
    const auto& c = b.faces[face].corners;
    return Triangle{moved_[c[0]], moved_[c[1]], moved_[c[2]]};
  };
  WorldBox box_b;
  for (const std::uint32_t vertex : of_b.vertices) box_b.merge(moved_[vertex]);
  for (const std::uint32_t i : of_a.faces) {
    const Triangle in_a = a.triangle(i);
    const WorldBox box = box_of_triangle(in_a);
    if (!boxes_touch(box, box_b)) continue;
    for (const std::uint32_t j : of_b.faces) {
      const Triangle in_b = moved(j);
      if (!boxes_touch(box, box_of_triangle(in_b))) continue;
      ++counters_.triangle_tests;
      if (touch(in_a, in_b, counters_.orientation) && found(PolygonPair{a.faces[i].polygon, b.faces[j].polygon})) {
        return true;
      }
    }
  }
  return false;
}

template <class Found>
bool ICollide::search(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b, Found found) {
  if (objects_.size() >= kObjectsMax) {
    objects_.clear();
    memories_.clear();
  }
  const Object& of_a = object(a);
  const Object& of_b = object(b);
  Memory& memory = memories_[{a.number, b.number}];
  place(*b.soup, of_b, a_from_b);
  sweep(memory, of_a, a.soup->box);
  const double room_m = 8.0 * kRounding *
                            (largest_coordinate(a.soup->box) + 3.0 * largest_coordinate(b.soup->box) +
                             a_from_b.translation.cwiseAbs().maxCoeff()) +
                        0x1p-200;
  for (Near& near : memory.near) {
    const SoupPiece &piece_a = of_a.pieces[near.pieces.a], &piece_b = of_b.pieces[near.pieces.b];
    if (walk_.apart({piece_a, a.soup->vertices}, {piece_b, moved_}, room_m, near.features)) continue;
    if (touch_pieces(*a.soup, *b.soup, piece_a, piece_b, found)) return true;
  }
  return false;
}

bool ICollide::find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                         PolygonPair& pair) {
  return first_visited([&](auto found) { return search(a, b, a_from_b, found); }, pair);
}

std::vector<PolygonPair> ICollide::all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                             const RelativeMotion& a_from_b) {
  return all_visited([&](auto found) { return search(a, b, a_from_b, found); });
}

}  // namespace peerd::collision::engines
