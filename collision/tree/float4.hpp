#pragma once

namespace peerd::collision {

// Four binary32 numbers, of which three are mostly a point's: the compiler's vectors, so that each operation is an IEEE
// one on every machine, and a tree is the same on all of them.
using Float4 = float __attribute__((vector_size(16)));

[[nodiscard]] inline Float4 all4(float x) { return Float4{x, x, x, x}; }
[[nodiscard]] inline Float4 max4(Float4 a, Float4 b) { return a < b ? b : a; }
[[nodiscard]] inline Float4 min4(Float4 a, Float4 b) { return b < a ? b : a; }

}  // namespace peerd::collision
