#include "collision/exact/linear_impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::linear_impact_test {

using Face = std::array<MovingPoint, 3>;
using Edge = std::array<MovingPoint, 2>;

MovingPoint still(const Vec3& p) { return {p, p}; }
MovingPoint moving(const Vec3& p, const Vec3& by) { return {p, p + by}; }

const Face kFloor = {still({0, 0, 0}), still({1, 0, 0}), still({0, 1, 0})};

TEST(VertexFaceImpact, IsWhereTheFallEnds) {
  for (const double height : {0.125, 0.3, 1.0}) {
    const LinearImpact impact = vertex_face_impact(moving({0.25, 0.25, height}, {0, 0, -2}), kFloor);
    EXPECT_EQ(impact.state, ImpactState::kHit);
    EXPECT_LE(impact.time, height / 2);
    EXPECT_NEAR(impact.time, height / 2, 1e-6);
  }
  EXPECT_EQ(vertex_face_impact(moving({0.25, 0.25, 2.1}, {0, 0, -2}), kFloor).state, ImpactState::kSeparated);
  EXPECT_EQ(vertex_face_impact(moving({0.51, 0.51, 1}, {0, 0, -2}), kFloor).state, ImpactState::kSeparated);
}

TEST(VertexFaceImpact, TouchesCount) {
  EXPECT_EQ(vertex_face_impact(moving({0.25, 0.25, 1}, {0, 0, -1}), kFloor).state, ImpactState::kHit);  // at the end
  EXPECT_EQ(vertex_face_impact(moving({0.5, 0.5, 1}, {0, 0, -2}), kFloor).state, ImpactState::kHit);    // on an edge
  EXPECT_EQ(vertex_face_impact(moving({1, 0, 1}, {0, 0, -2}), kFloor).state, ImpactState::kHit);        // on a corner
  const LinearImpact at_start = vertex_face_impact(moving({0.25, 0.25, 0}, {0, 0, 1}), kFloor);
  EXPECT_EQ(at_start.state, ImpactState::kHit);
  EXPECT_EQ(at_start.time, 0.0);
  // The vertex slides in the plane, into the face.
  const LinearImpact slides = vertex_face_impact(moving({-1, 0.25, 0}, {2, 0, 0}), kFloor);
  EXPECT_NE(slides.state, ImpactState::kSeparated);
  EXPECT_LE(slides.time, 0.5);
}

TEST(EdgeEdgeImpact, CrossingAndParallelEdges) {
  const Edge rail = {still({-1, 0, 0}), still({1, 0, 0})};
  const LinearImpact crosses = edge_edge_impact({moving({0, -1, 1}, {0, 0, -4}), moving({0, 1, 1}, {0, 0, -4})}, rail);
  EXPECT_EQ(crosses.state, ImpactState::kHit);
  EXPECT_LE(crosses.time, 0.25);
  EXPECT_NEAR(crosses.time, 0.25, 1e-6);
  // A whole stretch touches at once.
  const LinearImpact parallel =
      edge_edge_impact({moving({-1, 0, 1}, {0, 0, -4}), moving({1, 0, 1}, {0, 0, -4})}, rail, {.max_iterations = 64});
  EXPECT_EQ(parallel.state, ImpactState::kHit);
  EXPECT_LE(parallel.time, 0.25);
  EXPECT_NEAR(parallel.time, 0.25, 1e-6);
  EXPECT_EQ(edge_edge_impact({moving({-1, 1e-4, 1}, {0, 0, -4}), moving({1, 1e-4, 1}, {0, 0, -4})}, rail).state,
            ImpactState::kSeparated);
}

TEST(LinearImpact, IsSoughtBetweenTwoTimes) {
  LinearImpactQuery query;
  const MovingPoint falls = moving({0.25, 0.25, 1}, {0, 0, -2});
  const LinearImpact whole = query.vertex_face(falls, kFloor);
  for (const double begin : {0.0, 0.1, 0.3, 0.49}) {
    const LinearImpact impact = query.vertex_face(falls, kFloor, {.begin = begin});
    EXPECT_EQ(impact.state, ImpactState::kHit);
    EXPECT_LE(impact.time, 0.5);
    EXPECT_NEAR(impact.time, 0.5, 1e-6);
    EXPECT_EQ(query.vertex_face(falls, kFloor, {.begin = begin, .last = impact.time}).time, impact.time);
    EXPECT_EQ(query.vertex_face(falls, kFloor, {.begin = begin, .last = 0.4999}).state, ImpactState::kSeparated);
  }
  EXPECT_EQ(query.vertex_face(falls, kFloor, {.last = whole.time}).time, whole.time);
  EXPECT_EQ(query.vertex_face(falls, kFloor, {.begin = 0.51}).state, ImpactState::kSeparated);
  EXPECT_EQ(query.vertex_face(falls, kFloor, {.begin = 1.0}).state, ImpactState::kSeparated);
}

// Rational coordinates of binary64 numbers: the denominators are powers of two.
TEST(LinearImpact, MissesNoneOfTheRationalQueries) {
  const char* const corpus = std::getenv("PEERD_CORPUS");
  if (corpus == nullptr) GTEST_SKIP() << "PEERD_CORPUS is not set";
  int queries = 0, contacts = 0, more = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(corpus) / "ccd/rational-queries")) {
    if (entry.path().extension() != ".csv") continue;
    const bool of_face = entry.path().string().find("vertex-face") != std::string::npos;
    std::ifstream in(entry.path());
    std::vector<Vec3> p;
    for (std::string line; std::getline(in, line);) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream numbers(line);
      std::string numerator, denominator;
      Vec3& point = p.emplace_back();
      for (int k = 0; k < 3; ++k) {
        numbers >> numerator >> denominator;
        point[k] = std::strtod(numerator.c_str(), nullptr) / std::strtod(denominator.c_str(), nullptr);
      }
      bool truth = false;
      numbers >> truth;
      if (p.size() < 8) continue;
      const auto corner = [&](std::size_t i) { return MovingPoint{p[i], p[i + 4]}; };
      const ImpactOptions options{.max_iterations = 1u << 14};
      const LinearImpact impact = of_face ? vertex_face_impact(corner(0), {corner(1), corner(2), corner(3)}, options)
                                          : edge_edge_impact({corner(0), corner(1)}, {corner(2), corner(3)}, options);
      const bool hit = impact.state != ImpactState::kSeparated;
      EXPECT_TRUE(hit || !truth) << entry.path() << ", query " << queries;
      ++queries;
      contacts += truth;
      more += hit && !truth;
      p.clear();
    }
  }
  EXPECT_GT(queries, 0);
  RecordProperty("contacts", contacts);
  RecordProperty("hits_without_contact", more);
}

}  // namespace peerd::collision::linear_impact_test
