#include "collision/contact/rigid_step.hpp"

#include <gtest/gtest.h>

#include "tests/collision/soups.hpp"

namespace peerd::collision::rigid_step_test {

Affine map_of(const Pose& pose) { return {pose.orientation.toRotationMatrix(), pose.position}; }

struct WholeStep {
  std::vector<Vec3> at_begin, at_end;
  std::vector<TriangleSoup::Face> faces;
  WholeStep(const TriangleSoup& soup, const Affine& begin, const Affine& end) : faces(soup.faces) {
    for (const Vec3& p : soup.vertices) {
      at_begin.push_back(multiply(begin.linear, p) + begin.offset);
      at_end.push_back(multiply(end.linear, p) + end.offset);
    }
  }
  [[nodiscard]] SoupStep step() const { return {at_begin, at_end, faces}; }
};

// A small soup falls onto a part of a large one that turns: the part alone gives the answer of the whole.
TEST(RigidStep, WhatIsGatheredHasTheAnswerOfTheWhole) {
  const TriangleSoup large = torus(32, 64, true), small = random_soup(30, 0.1, 131);
  WideTree tree(large);
  Numbers numbers(132);
  RigidStep part;
  SoupImpactQuery query;
  int contacts = 0;
  std::size_t gathered = 0;
  for (int i = 0; i < 40; ++i) {
    const Affine begin = map_of(random_pose(numbers, 0.3));
    Affine end{quat_exp(numbers.point(0.2)).toRotationMatrix() * begin.linear, begin.offset + numbers.point(0.3)};
    const Vec3 from = numbers.point(2.0);
    const Affine small_begin{0.3 * Mat3::Identity(), from}, small_end{0.3 * Mat3::Identity(), from - 0.6 * from};
    const WholeStep a(small, small_begin, small_end), b(large, begin, end);
    const double margin = i % 2 == 0 ? 0.0 : 0.01;
    part.gather(tree, begin, end, swept_box(a.step(), margin));
    gathered += part.step().faces.size();
    const SoupImpact whole = query.first_impact(a.step(), b.step(), {.margin_m = margin});
    const SoupImpact found = query.first_impact(a.step(), part.step(), {.margin_m = margin});
    ASSERT_EQ(found.state, whole.state) << i;
    ASSERT_EQ(found.fraction, whole.fraction) << i;
    ASSERT_EQ(found.polygons, whole.polygons) << i;
    if (whole.state == SoupImpactState::kSeparated) continue;
    ASSERT_EQ(part.face_of_soup(found.faces.b), whole.faces.b) << i;
    ++contacts;
  }
  EXPECT_GT(contacts, 10);
  EXPECT_LT(gathered, 40 * large.faces.size() / 2);
}

TEST(RigidStep, ASweptBoxHasItsMargin) {
  const std::vector<Vec3> begin = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}},
                          end = {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {9, 9, 9}};
  const std::vector<TriangleSoup::Face> faces = {{{0, 1, 2}, 0}};
  const WorldBox box = swept_box(SoupStep{begin, end, faces}, 0.1);
  EXPECT_LT(box.lo[0], -0.1);
  EXPECT_NEAR(box.lo[0], -0.1, 1e-15);
  EXPECT_GT(box.hi[2], 2.1);
  EXPECT_NEAR(box.hi[2], 2.1, 1e-15);
  EXPECT_TRUE(swept_box(SoupStep{}, 0.1).is_empty());
}

}  // namespace peerd::collision::rigid_step_test
