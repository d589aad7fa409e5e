#pragma once
#include <array>

#include "collision/exact/triangle_pair.hpp"

namespace peerd::bench {

// Ways to ask whether two triangles touch.
struct Narrow {
  const char* name;
  bool (*touch)(const collision::Triangle& a, const collision::Triangle& b);
};
enum NarrowIndex : std::size_t { kThesis, kFloat, kDouble, kFiltered, kExact };
[[nodiscard]] const std::array<Narrow, 5>& narrow_tests();

}  // namespace peerd::bench
