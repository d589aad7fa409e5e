#include "collision/engines/convex_pieces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/collision/engines/convex_soups.hpp"

namespace peerd::collision::engines::convex_pieces_test {

using ::testing::SizeIs;

void append(TriangleSoup& soup, const TriangleSoup& other) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (TriangleSoup::Face face : other.faces) {
    for (std::uint32_t& corner : face.corners) corner += first;
    soup.faces.push_back(face);
  }
  soup.box.merge(other.box);
}

TEST(ConvexPieces, AClosedConvexPolyhedronIsOne) {
  const auto box = convex_pieces(closed_box({1, 2, 3}));
  ASSERT_THAT(box, SizeIs(1));
  EXPECT_THAT(box[0].vertices, SizeIs(8));
  EXPECT_THAT(box[0].faces, SizeIs(12));
  EXPECT_THAT(box[0].neighbors[0], SizeIs(testing::Ge(3u)));
  EXPECT_THAT(convex_pieces(spindle(20)), SizeIs(1));
}

TEST(ConvexPieces, VerticesOfOnePlaceAreOne) {
  TriangleSoup apart = closed_box({1, 1, 1});
  std::vector<Vec3> vertices;
  for (TriangleSoup::Face& face : apart.faces) {
    for (std::uint32_t& corner : face.corners) {
      vertices.push_back(apart.vertices[corner]);
      corner = static_cast<std::uint32_t>(vertices.size() - 1);
    }
  }
  apart.vertices = vertices;
  const auto pieces = convex_pieces(apart);
  ASSERT_THAT(pieces, SizeIs(1));
  EXPECT_THAT(pieces[0].vertices, SizeIs(8));
}

TEST(ConvexPieces, PartsOfASoupAreTakenOneByOne) {
  TriangleSoup soup = closed_box({1, 1, 1});
  append(soup, closed_box({1, 1, 1}, {5, 0, 0}));
  append(soup, random_soup(3, 0.5, 1));
  EXPECT_THAT(convex_pieces(soup), SizeIs(2 + 3));
}

TEST(ConvexPieces, InsideOutIsConvexToo) {
  TriangleSoup soup = spindle(8);
  for (TriangleSoup::Face& face : soup.faces) std::swap(face.corners[1], face.corners[2]);
  EXPECT_THAT(convex_pieces(soup), SizeIs(1));
}

TEST(ConvexPieces, WhatIsOpenConcaveOrFlatIsItsTriangles) {
  EXPECT_THAT(convex_pieces(torus(6, 12, true)), SizeIs(2 * 6 * 12));
  TriangleSoup open = closed_box({1, 1, 1});
  open.faces.pop_back();
  EXPECT_THAT(convex_pieces(open), SizeIs(11));
  TriangleSoup dented = closed_box({1, 1, 1});
  dented.vertices[7] = {0.1, 0.1, 0.1};
  EXPECT_THAT(convex_pieces(dented), SizeIs(12));
  TriangleSoup flat = closed_box({1, 1, 1});
  for (Vec3& v : flat.vertices) v[2] = 0.0;
  EXPECT_THAT(convex_pieces(flat), SizeIs(12));
  TriangleSoup turned = closed_box({1, 1, 1});
  std::swap(turned.faces[0].corners[0], turned.faces[0].corners[1]);
  EXPECT_THAT(convex_pieces(turned), SizeIs(12));
}

}  // namespace peerd::collision::engines::convex_pieces_test
