#pragma once
#include <cstdint>

#include "collision/query/wide_motion.hpp"
#include "collision/tree/wide_tree.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::test {

// Two built trees and the motion between them, for tests of the kernels on single nodes and leaves.
struct WidePair {
  TriangleSoup a, b;
  WideTree tree_a, tree_b;
  RelativeMotion a_from_b;

  WidePair(TriangleSoup soup_a, TriangleSoup soup_b, const RelativeMotion& motion)
      : a(std::move(soup_a)), b(std::move(soup_b)), tree_a(a), tree_b(b), a_from_b(motion) {
    tree_a.build_all();
    tree_b.build_all();
  }
  WidePair(const WidePair&) = delete;
  WidePair& operator=(const WidePair&) = delete;

  [[nodiscard]] Triangle of_a(std::uint32_t face) const { return a.triangle(face); }
  [[nodiscard]] Triangle of_b(std::uint32_t face) const {
    const Triangle t = b.triangle(face);
    return {a_from_b(t[0]), a_from_b(t[1]), a_from_b(t[2])};
  }
};

}  // namespace peerd::collision::test
