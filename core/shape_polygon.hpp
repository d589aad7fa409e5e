#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"

namespace peerd {

// A polygon of a Shape: `polygon` counts in file order.
struct ShapePolygon {
  ObjectId shape;
  std::uint32_t polygon = 0;
  friend auto operator<=>(const ShapePolygon&, const ShapePolygon&) = default;
};

struct ShapePair {
  ShapePolygon collider, collidee;
  friend auto operator<=>(const ShapePair&, const ShapePair&) = default;
};

// The pairs of polygons of a contact, as it is passed on: how many there are, and the first of them.
struct TouchedPolygons {
  static constexpr std::size_t kKept = 64;  // a row of more would be longer than all others of its table

  std::uint64_t count = 0;
  std::vector<ShapePair> pairs;  // sorted, each once: the first kKept
};

}  // namespace peerd
