#include "collision/query/collect_faces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/collision/soups.hpp"

namespace peerd::collision::collect_faces_test {

Vec3 place(const Affine& m, const Vec3& p) { return multiply(m.linear, p) + m.offset; }

std::vector<std::uint32_t> brute_force(const TriangleSoup& soup, const Affine& at_begin, const Affine& at_end,
                                       const WorldBox& box) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face) {
    WorldBox swept;
    for (const Vec3& corner : soup.triangle(face)) {
      swept.merge(place(at_begin, corner));
      swept.merge(place(at_end, corner));
    }
    bool touches = true;
    for (int k = 0; k < 3; ++k) touches = touches && swept.lo[k] <= box.hi[k] && box.lo[k] <= swept.hi[k];
    if (touches) out.push_back(face);
  }
  return out;
}

WorldBox random_box(Numbers& numbers, double size) {
  const Vec3 middle = numbers.point(1.2), half = numbers.point(size).cwiseAbs();
  return {middle - half, middle + half};
}

Affine random_map(Numbers& numbers, double shear) {
  Affine map{quat_exp(numbers.point(2.0)).toRotationMatrix(), numbers.point(0.5)};
  for (int k = 0; k < 3; ++k) map.linear.col(k) += numbers.point(shear);
  return map;
}

TEST(CollectFaces, FindsAllThatTouchAndNoOthers) {
  const TriangleSoup soup = random_soup(700, 0.1, 121);
  Numbers numbers(122);
  WideTree tree(soup);
  std::vector<std::uint32_t> faces;
  std::size_t found = 0;
  for (int i = 0; i < 200; ++i) {
    const WorldBox box = random_box(numbers, i % 2 == 0 ? 0.05 : 0.5);
    collect_faces(tree, box, faces);
    ASSERT_EQ(faces, brute_force(soup, {}, {}, box)) << i;
    found += faces.size();
    const Affine at_begin = random_map(numbers, 0.3), at_end = random_map(numbers, 0.3);
    collect_moving_faces(tree, at_begin, at_end, box, faces);
    ASSERT_EQ(faces, brute_force(soup, at_begin, at_end, box)) << i;
    found += faces.size();
  }
  EXPECT_GT(found, 1000u);
  collect_faces(tree, WorldBox{}, faces);
  EXPECT_TRUE(faces.empty());
}

// A box whose side is exactly that of a face, or the next number beside it.
TEST(CollectFaces, SidesThatAreEqualTouch) {
  for (const double far : {0.0, 1e6, 0x1p90}) {
    TriangleSoup soup = random_soup(300, 0.1, 123);
    for (Vec3& p : soup.vertices) p.array() += far;
    find_box(soup);
    WideTree tree(soup);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t face = 0; face < soup.faces.size(); face += 7) {
      WorldBox box;
      for (const Vec3& p : soup.triangle(face)) box.merge(p);
      WorldBox beside = box;
      beside.lo[0] = beside.hi[0] = box.lo[0];
      collect_faces(tree, beside, faces);
      ASSERT_EQ(faces, brute_force(soup, {}, {}, beside));
      ASSERT_TRUE(std::ranges::binary_search(faces, face));
      beside.lo[0] = beside.hi[0] = std::nextafter(box.lo[0], -1e300);
      collect_faces(tree, beside, faces);
      ASSERT_EQ(faces, brute_force(soup, {}, {}, beside));
    }
  }
}

TEST(CollectFaces, BuildsOnlyWhatIsNear) {
  const TriangleSoup soup = torus(128, 256, false);
  ASSERT_EQ(soup.faces.size(), 65'536u);
  WideTree tree(soup);
  std::vector<std::uint32_t> faces;
  const Vec3 somewhere = soup.vertices[1234], half = Vec3::Constant(0.01);
  collect_faces(tree, {somewhere - half, somewhere + half}, faces);
  EXPECT_FALSE(faces.empty());
  EXPECT_LT(faces.size(), 100u);
  EXPECT_LT(tree.nodes_built(), 200u);
}

}  // namespace peerd::collision::collect_faces_test
