#include "collision/tree/realignment.hpp"

#include <gtest/gtest.h>

#include "collision/tree/kdop_tree.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::realignment_test {

template <class Ks>
class RealignmentTest : public ::testing::Test {};

template <int K>
struct Faces {
  static constexpr int kFaces = K;
};
using AllKs = ::testing::Types<Faces<6>, Faces<14>, Faces<18>, Faces<26>>;
TYPED_TEST_SUITE(RealignmentTest, AllKs);

// Without turning, the slabs are the old ones, moved, but for the padding.
TYPED_TEST(RealignmentTest, WithoutRotationKeepsTheSlabs) {
  constexpr int K = TypeParam::kFaces;
  const TriangleSoup soup = random_soup(20, 0.8, 12);
  KdopTree<K> tree(soup, {});
  const WideKdop<K> dop = Realignment<K>(RelativeMotion(Pose{}, Pose{}), 2.0)(tree.node(0).dop);
  for (std::size_t i = 0; i < dop.kSlabs; ++i) {
    EXPECT_NEAR(dop.lo[i], tree.node(0).dop.lo[i], 1e-12);
    EXPECT_NEAR(dop.hi[i], tree.node(0).dop.hi[i], 1e-12);
  }
}

}  // namespace peerd::collision::realignment_test
