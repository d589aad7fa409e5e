#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "tests/oracle/triangle_cases.hpp"
#include "tests/oracle/triangle_oracle.hpp"
#include "tests/oracle/triangle_oracle_second.hpp"
#include "tests/oracle/tritri_files.hpp"

namespace peerd::oracle {

std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  for (const Triangle* triangle : {&pair.a, &pair.b}) {
    for (const Point& point : *triangle) {
      std::array<char, 96> text;
      std::snprintf(text.data(), text.size(), "{%a, %a, %a} ", point[0], point[1], point[2]);
      out << text.data();
    }
  }
  return out;
}

}  // namespace peerd::oracle

namespace peerd::oracle::oracle_test {

constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr double kUp = 1 + std::numeric_limits<double>::epsilon();  // times a power of two: its next neighbour

bool touch(const Pair& pair) { return oracle::touch(pair.a, pair.b); }
bool touch_by_simplex(const Pair& pair) { return oracle::touch_by_simplex(pair.a, pair.b); }

// The 72 orders: 6 of each triangle's points, and which triangle is the first.
template <class Visit>
void each_order(const Pair& pair, const Visit& visit) {
  std::array<std::size_t, 3> i{0, 1, 2};
  do {
    const Triangle a{pair.a[i[0]], pair.a[i[1]], pair.a[i[2]]};
    std::array<std::size_t, 3> j{0, 1, 2};
    do {
      const Triangle b{pair.b[j[0]], pair.b[j[1]], pair.b[j[2]]};
      visit(Pair{a, b});
      visit(Pair{b, a});
    } while (std::ranges::next_permutation(j).found);
  } while (std::ranges::next_permutation(i).found);
}

template <class Change>
Pair each_point(Pair pair, const Change& change) {
  for (Triangle* triangle : {&pair.a, &pair.b}) {
    for (Point& point : *triangle) point = change(point);
  }
  return pair;
}

// Hand-worked cases

struct Case {
  const char* name;
  Triangle a, b;
  bool touch;
};

// The triangle of most cases: x >= 0, y >= 0, x + y <= 4 in z = 0.
constexpr Triangle kFloor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
// x, y, z >= 0 in x + y + z = 6.
constexpr Triangle kTilted{{{6, 0, 0}, {0, 6, 0}, {0, 0, 6}}};

constexpr Triangle triangle(const Point& p, const Point& q, const Point& r) { return {p, q, r}; }
constexpr Triangle flat(std::array<double, 2> p, std::array<double, 2> q, std::array<double, 2> r) {
  return {{{p[0], p[1], 0}, {q[0], q[1], 0}, {r[0], r[1], 0}}};
}
constexpr Triangle segment(const Point& p, const Point& q) { return {p, q, q}; }
constexpr Triangle point(const Point& p) { return {p, p, p}; }

const Case kCases[] = {
    // Across the plane
    {"PiercedInside", kFloor, triangle({1, 1, -1}, {1, 1, 1}, {5, 5, 1}), true},
    {"PiercedOnAnEdge", kFloor, triangle({2, 2, -1}, {2, 2, 1}, {5, 5, 1}), true},
    {"PiercedAnUlpBesideAnEdge", kFloor, triangle({2, 2 * kUp, -1}, {2, 2 * kUp, 1}, {5, 5, 1}), false},
    {"PiercedOnAVertex", kFloor, triangle({0, 0, -1}, {0, 0, 1}, {-3, -3, 0}), true},
    {"PassesBeside", kFloor, triangle({3, 3, -1}, {3, 3, 1}, {5, 5, 1}), false},
    {"PassesADenormalBesideAVertex", kFloor, triangle({-kTiny, 0, -1}, {-kTiny, 0, 1}, {-3, 0, 0}), false},
    {"EdgesCross", kFloor, triangle({2, -1, -1}, {2, 1, 1}, {2, -5, 5}), true},
    {"EdgesPass", kFloor, triangle({2, -1, -0.5}, {2, 1, 1.5}, {2, -5, 5}), false},
    {"BothPierceEachOther", kFloor, triangle({1, -1, -1}, {1, 6, -1}, {1, 1, 3}), true},
    {"Interlocked", kFloor, triangle({1, 1, -2}, {1, 1, 2}, {1, -9, 0}), true},
    {"WholeAbove", kFloor, triangle({1, 1, 1}, {2, 1, 2}, {1, 2, 3}), false},
    {"WholeBelow", kFloor, triangle({1, 1, -1}, {2, 1, -2}, {1, 2, -3}), false},
    // A vertex in the plane
    {"VertexOnFace", kFloor, triangle({1, 1, 0}, {1, 1, 3}, {2, 1, 3}), true},
    {"VertexADenormalAboveFace", kFloor, triangle({1, 1, kTiny}, {1, 1, 3}, {2, 1, 3}), false},
    {"VertexADenormalBelowFace", kFloor, triangle({1, 1, -kTiny}, {1, 1, 3}, {2, 1, 3}), true},
    {"VertexOnEdge", kFloor, triangle({2, 0, 0}, {2, -3, 1}, {3, -3, 1}), true},
    {"VertexADenormalBesideEdge", kFloor, triangle({2, -kTiny, 0}, {2, -3, 1}, {3, -3, 1}), false},
    {"VertexOnVertex", kFloor, triangle({0, 0, 0}, {-1, -1, 1}, {-1, -2, 1}), true},
    {"VertexOnVertexOfOtherSign", kFloor, triangle({-0.0, -0.0, -0.0}, {-1, -1, 1}, {-1, -2, 1}), true},
    {"VertexADenormalFromVertex", kFloor, triangle({-kTiny, -kTiny, 0}, {-1, -1, 1}, {-1, -2, 1}), false},
    {"VertexInPlaneOutside", kFloor, triangle({3, 3, 0}, {3, 3, 2}, {4, 3, 2}), false},
    {"VertexOnTiltedFace", kTilted, triangle({2, 2, 2}, {5, 5, 5}, {5, 5, 6}), true},
    {"VertexAnUlpAboveTiltedFace", kTilted, triangle({2, 2, 2 * kUp}, {5, 5, 5}, {5, 5, 6}), false},
    // An edge in the plane
    {"EdgeAcrossFace", kFloor, triangle({-1, 1, 0}, {5, 1, 0}, {1, 1, 5}), true},
    {"EdgeWithinFace", kFloor, triangle({1, 1, 0}, {2, 1, 0}, {1, 1, 5}), true},
    {"EdgeInPlaneOutside", kFloor, triangle({5, 0, 0}, {5, 5, 0}, {5, 1, 5}), false},
    {"EdgeInPlaneOnVertex", kFloor, triangle({4, -1, 0}, {4, 1, 0}, {4, 0, 5}), true},
    {"EdgesOverlap", kFloor, triangle({2, 0, 0}, {6, 0, 0}, {3, -1, 3}), true},
    {"EdgesAbut", kFloor, triangle({4, 0, 0}, {6, 0, 0}, {5, -1, 3}), true},
    {"EdgesOnOneLineApart", kFloor, triangle({4 * kUp, 0, 0}, {6, 0, 0}, {5, -1, 3}), false},
    {"SharedEdgeAcross", kFloor, triangle({4, 0, 0}, {0, 4, 0}, {3, 3, 3}), true},
    // One plane
    {"Equal", kFloor, kFloor, true},
    {"EqualTilted", kTilted, triangle({0, 6, 0}, {6, 0, 0}, {0, 0, 6}), true},
    {"Within", kFloor, flat({1, 1}, {2, 1}, {1, 2}), true},
    {"Around", kFloor, flat({-10, -10}, {30, -10}, {-10, 30}), true},
    {"NoVertexInTheOther", kFloor, flat({-1, 1}, {5, 1.5}, {-1, 2}), true},
    {"CoplanarApart", kFloor, flat({5, 5}, {6, 5}, {5, 6}), false},
    {"CoplanarApartInOneBox", kFloor, flat({3, 3}, {4, 2}, {4, 4}), false},
    {"CoplanarVertexOnVertex", kFloor, flat({4, 0}, {6, -1}, {6, 1}), true},
    {"CoplanarVertexOnEdge", kFloor, flat({2, 2}, {5, 2}, {2, 5}), true},
    {"CoplanarVertexAnUlpFromEdge", kFloor, flat({2 * kUp, 2}, {5, 2}, {3, 5}), false},
    {"CoplanarSharedEdge", kFloor, flat({4, 0}, {0, 4}, {4, 4}), true},
    {"CoplanarSharedEdgeSameSide", kFloor, flat({4, 0}, {0, 4}, {1, 1}), true},
    {"CoplanarEdgesOverlap", kFloor, flat({1, 0}, {3, 0}, {2, -2}), true},
    {"CoplanarEdgesOnOneLineApart", kFloor, flat({5, 0}, {7, 0}, {6, -2}), false},
    {"WithinTilted", kTilted, triangle({2, 2, 2}, {3, 2, 1}, {2, 3, 1}), true},
    {"CoplanarTiltedApart", kTilted, triangle({7, -3, 2}, {8, -3, 1}, {9, -5, 2}), false},
    {"CoplanarTiltedVertexOnEdge", kTilted, triangle({3, 0, 3}, {5, -3, 4}, {4, -3, 5}), true},
    {"ParallelPlanes", kFloor, triangle({0, 0, 1}, {4, 0, 1}, {0, 4, 1}), false},
    {"ParallelPlanesADenormalApart", kFloor, triangle({0, 0, kTiny}, {4, 0, kTiny}, {0, 4, kTiny}), false},
    // Point and point
    {"PointsEqual", point({1, 2, 3}), point({1, 2, 3}), true},
    {"PointsEqualButForTheSignOfZero", point({0, 0, 0}), point({-0.0, 0, -0.0}), true},
    {"PointsApart", point({1, 2, 3}), point({1, 2, 4}), false},
    {"PointsADenormalApart", point({0, 0, 0}), point({0, kTiny, 0}), false},
    // Point and segment
    {"PointOnEnd", point({2, 2, 2}), segment({0, 0, 0}, {2, 2, 2}), true},
    {"PointOnSegment", point({1, 1, 1}), segment({0, 0, 0}, {2, 2, 2}), true},
    {"PointBeyondEnd", point({2 * kUp, 2 * kUp, 2 * kUp}), segment({0, 0, 0}, {2, 2, 2}), false},
    {"PointAnUlpBesideSegment", point({1, 1, kUp}), segment({0, 0, 0}, {2, 2, 2}), false},
    {"PointOnSegmentOfTwoEqualPoints", point({1, 1, 1}), triangle({0, 0, 0}, {0, 0, 0}, {2, 2, 2}), true},
    {"PointOnSegmentOfThreePoints", point({1.5, 1.5, 1.5}), triangle({0, 0, 0}, {2, 2, 2}, {1, 1, 1}), true},
    {"PointOnSegmentOfThreePointsInOrder", point({1.5, 1.5, 1.5}), triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), true},
    {"PointBeyondSegmentOfThreePoints", point({3, 3, 3}), triangle({0, 0, 0}, {2, 2, 2}, {1, 1, 1}), false},
    {"PointOnSegmentAlongAxis", point({0, 1, 0}), segment({0, 0, 0}, {0, 2, 0}), true},
    {"PointBesideSegmentAlongAxis", point({0, 1, kTiny}), segment({0, 0, 0}, {0, 2, 0}), false},
    {"TwiceATenthIsTwoTenths", point({0.1, 0.2, 0}), segment({0, 0, 0}, {1, 2, 0}), true},
    {"ThriceATenthIsNotThreeTenths", point({0.1, 0.3, 0}), segment({0, 0, 0}, {1, 3, 0}), false},
    // Point and triangle
    {"PointInside", point({1, 1, 0}), kFloor, true},
    {"PointOnAnEdge", point({1, 3, 0}), kFloor, true},
    {"PointAnUlpOutside", point({kUp, 3, 0}), kFloor, false},
    {"PointOnAVertex", point({0, 4, 0}), kFloor, true},
    {"PointInPlaneOutside", point({3, 3, 0}), kFloor, false},
    {"PointADenormalAbove", point({1, 1, kTiny}), kFloor, false},
    {"PointOnTilted", point({1, 2, 3}), kTilted, true},
    {"PointAnUlpFromTilted", point({1, 3, 2 * kUp}), kTilted, false},
    // Segment and segment
    {"SegmentsCross", segment({0, 0, 0}, {2, 2, 2}), segment({2, 0, 1}, {0, 2, 1}), true},
    {"SegmentsSkew", segment({0, 0, 0}, {2, 2, 2}), segment({2, 0, kUp}, {0, 2, kUp}), false},
    {"SegmentEndsOnSegment", segment({0, 0, 0}, {2, 2, 2}), segment({1, 1, 1}, {0, 5, 7}), true},
    {"SegmentsMeetAtEnds", segment({0, 0, 0}, {2, 2, 2}), segment({2, 2, 2}, {0, 5, 7}), true},
    {"SegmentsWouldCrossBeyond", segment({0, 0, 0}, {2, 2, 2}), segment({4, 2, 3}, {2, 4, 3}), false},
    {"SegmentsOverlap", segment({0, 0, 0}, {2, 2, 2}), segment({1, 1, 1}, {3, 3, 3}), true},
    {"SegmentsAbut", segment({0, 0, 0}, {2, 2, 2}), segment({2, 2, 2}, {3, 3, 3}), true},
    {"SegmentsOnOneLineApart", segment({0, 0, 0}, {2, 2, 2}), segment({2.5, 2.5, 2.5}, {3, 3, 3}), false},
    {"SegmentsParallel", segment({0, 0, 0}, {2, 2, 2}), segment({0, 0, 1}, {2, 2, 3}), false},
    {"SegmentsEqual", segment({0, 0, 0}, {2, 2, 2}), triangle({2, 2, 2}, {1, 1, 1}, {0, 0, 0}), true},
    {"SegmentWithinSegment", segment({0, 0, 0}, {4, 4, 4}), segment({1, 1, 1}, {3, 3, 3}), true},
    {"SegmentsOfThreePointsCross", triangle({0, 0, 0}, {3, 3, 0}, {1, 1, 0}),
     triangle({2.5, 2, 0}, {2, 3, 0}, {2.25, 2.5, 0}), true},
    // Segment and triangle
    {"SegmentPierces", segment({1, 1, -1}, {1, 1, 1}), kFloor, true},
    {"SegmentPiercesOnEdge", segment({2, 2, -1}, {2, 2, 1}), kFloor, true},
    {"SegmentPiercesOnVertex", segment({4, 0, -1}, {4, 0, 1}), kFloor, true},
    {"SegmentPassesBeside", segment({2, 2 * kUp, -1}, {2, 2 * kUp, 1}), kFloor, false},
    {"SegmentStopsShort", segment({1, 1, kTiny}, {1, 1, 1}), kFloor, false},
    {"SegmentEndsOnFace", segment({1, 1, 0}, {1, 1, 1}), kFloor, true},
    {"SegmentWithin", segment({1, 1, 0}, {2, 1, 0}), kFloor, true},
    {"SegmentInPlaneAcross", segment({-1, 1, 0}, {9, 1, 0}), kFloor, true},
    {"SegmentInPlaneOutside", segment({3, 2, 0}, {2, 3, 0}), kFloor, false},
    {"SegmentInPlaneOnVertex", segment({4, -1, 0}, {4, 1, 0}), kFloor, true},
    {"SegmentAlongEdge", segment({-1, 0, 0}, {1, 0, 0}), kFloor, true},
    {"SegmentOnEdgesLineApart", segment({-2, 0, 0}, {-1, 0, 0}), kFloor, false},
    {"SegmentParallel", segment({1, 1, 1}, {2, 1, 1}), kFloor, false},
    {"SegmentOfThreePointsPierces", triangle({1, 1, 1}, {1, 1, 3}, {1, 1, -1}), kFloor, true},
    {"SegmentInTiltedPlaneAcross", segment({-1, 3, 4}, {9, 1, -4}), kTilted, true},
    // Scales
    {"DenormalPointInHugeTriangle", point({kTiny, kTiny, 0}), triangle({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}), true},
    {"DenormalPointOffHugeTriangle", point({kTiny, kTiny, kTiny}), triangle({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}),
     false},
    {"DenormalTriangles", triangle({0, 0, 0}, {kTiny, 0, 0}, {0, kTiny, 0}),
     triangle({kTiny, 0, 0}, {kTiny, kTiny, 0}, {0, kTiny, kTiny}), true},
    {"DenormalTrianglesApart", triangle({0, 0, 0}, {kTiny, 0, 0}, {0, kTiny, 0}),
     triangle({kTiny, kTiny, 0}, {kTiny, kTiny, kTiny}, {2 * kTiny, kTiny, 0}), false},
    {"GreatestNumbers", triangle({-1.7e308, 0, 0}, {1.7e308, 1.7e308, 0}, {1.7e308, -1.7e308, 0}),
     segment({0, 0, -1.7e308}, {0, 0, 1.7e308}), true},
};

class TriangleOracleTable : public testing::TestWithParam<Case> {};
TEST_P(TriangleOracleTable, AnswersInEveryOrder) {
  const Case& c = GetParam();
  each_order({c.a, c.b}, [&](const Pair& pair) {
    EXPECT_EQ(touch(pair), c.touch) << pair;
    EXPECT_EQ(touch_by_simplex(pair), c.touch) << pair;
  });
}
INSTANTIATE_TEST_SUITE_P(HandWorked, TriangleOracleTable, testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Generated pairs

std::vector<Generator> all_generators() {
  std::vector<Generator> all(general().begin(), general().end());
  all.insert(all.end(), adversarial().begin(), adversarial().end());
  return all;
}

template <class Visit>
void each_pair(std::uint64_t seed, int count, const Visit& visit) {
  for (const Generator& generator : all_generators()) {
    SCOPED_TRACE(generator.name);
    Rng rng(seed);
    for (int i = 0; i < count; ++i) {
      visit(generator.make(rng));
      if (testing::Test::HasFailure()) return;
    }
  }
}

// The check runs in parts, for a sanitizer makes each of GMP's many small allocations slow.
constexpr int kParts = 6;
class TriangleOraclePart : public testing::TestWithParam<int> {};
TEST_P(TriangleOraclePart, AgreesWithTheSecond) {
  std::size_t pairs = 0;
  each_pair(100 + static_cast<std::uint64_t>(GetParam()), 40, [&](const Pair& pair) {
    EXPECT_EQ(touch(pair), touch_by_simplex(pair)) << pair;
    ++pairs;
  });
  EXPECT_GE(kParts * pairs, 20'000u);
}
INSTANTIATE_TEST_SUITE_P(Seeds, TriangleOraclePart, testing::Range(0, kParts));

TEST(TriangleOracle, IsTheSameInEveryOrder) {
  each_pair(2, 5, [](const Pair& pair) {
    const bool expected = touch(pair);
    each_order(pair, [&](const Pair& other) { EXPECT_EQ(touch(other), expected) << other; });
  });
}

TEST(TriangleOracle, IsTheSameWhenAxesArePermutedAndMirrored) {
  each_pair(3, 10, [](const Pair& pair) {
    const bool expected = touch(pair);
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {
      for (const double sign : {1.0, -1.0}) {
        const Pair other = each_point(pair, [&](const Point& p) {
          return Point{sign * p[axes[0]], p[axes[1]], p[axes[2]]};
        });
        EXPECT_EQ(touch(other), expected) << other;
      }
    } while (std::ranges::next_permutation(axes).found);
  });
}

TEST(TriangleOracle, IsTheSameAtEveryExactScale) {
  std::size_t scaled = 0;
  each_pair(4, 10, [&](const Pair& pair) {
    const bool expected = touch(pair);
    for (const int exponent : {-900, -100, -1, 1, 100, 500}) {
      const auto by = [](const Pair& p, int n) {
        return each_point(p, [n](const Point& x) {
          return Point{std::ldexp(x[0], n), std::ldexp(x[1], n), std::ldexp(x[2], n)};
        });
      };
      const Pair other = by(pair, exponent), back = by(other, -exponent);
      if (back.a != pair.a || back.b != pair.b) continue;  // it rounded, or became infinite
      EXPECT_EQ(touch(other), expected) << other;
      ++scaled;
    }
  });
  EXPECT_GT(scaled, 2'500u);
}

TEST(TriangleCases, KeepTheirPromises) {
  for (const Generator& generator : all_generators()) {
    SCOPED_TRACE(generator.name);
    Rng rng(5);
    constexpr int kPairs = 300;
    int touching = 0;
    for (int i = 0; i < kPairs; ++i) {
      const Pair pair = generator.make(rng);
      each_point(pair, [&](const Point& p) {
        EXPECT_TRUE(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) << pair;
        return p;
      });
      touching += touch(pair) ? 1 : 0;
    }
    if (generator.name.starts_with("touch_")) {
      EXPECT_EQ(touching, kPairs);
    } else if (generator.name.starts_with("apart_")) {
      EXPECT_EQ(touching, 0);
    } else {
      EXPECT_GT(touching, 0);
      EXPECT_LT(touching, kPairs);
    }
  }
}

TEST(TriangleCases, Binary32IsWhatItSays) {
  for (const Generator& generator : all_generators()) {
    if (!generator.name.ends_with("_f32")) continue;
    SCOPED_TRACE(generator.name);
    Rng rng(7);
    for (int i = 0; i < 100; ++i) {
      each_point(generator.make(rng), [](const Point& p) {
        for (const double x : p) EXPECT_EQ(std::bit_cast<std::uint64_t>(x) << 35, 0u) << x;  // 29 bits of 52 unused
        return p;
      });
    }
  }
}

TEST(TriangleCases, NamesDiffer) {
  std::vector<std::string_view> names;
  for (const Generator& generator : all_generators()) names.push_back(generator.name);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

// A seed that a test prints must mean the same pairs elsewhere. The hash (FNV-1a over the coordinates' bits) changes
// with every change to a generator; then write the new one here.
TEST(TriangleCases, AreTheSameEverywhere) {
  std::uint64_t hash = 0xcbf29ce484222325;
  each_pair(6, 100, [&](const Pair& pair) {
    each_point(pair, [&](const Point& p) {
      for (const double x : p) hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3;
      return p;
    });
  });
  EXPECT_EQ(hash, 13209863061846086555u);
}

// Real files

TEST(TritriFiles, MissingFolderIsSaid) {
  const RecordedPairs pairs = read_regression_pairs("no such folder");
  ASSERT_FALSE(pairs);
  EXPECT_NE(pairs.error().find("regression_tritri.txt: cannot be read"), std::string::npos) << pairs.error();
}

TEST(TritriFilesCorpus, BothOraclesSayWhatIsRecorded) {
  const char* const folder = std::getenv("PEERD_CORPUS");
  if (folder == nullptr) GTEST_SKIP() << "PEERD_CORPUS does not name the folder of real files";
  for (const auto read : {read_regression_pairs, read_shen2003_pairs}) {
    const RecordedPairs pairs = read(folder);
    ASSERT_TRUE(pairs) << pairs.error();
    EXPECT_GE(pairs->size(), 6u);
    for (const RecordedPair& recorded : *pairs) {
      ASSERT_TRUE(recorded.touch) << recorded.source;
      EXPECT_EQ(touch(recorded.pair), *recorded.touch) << recorded.source << ' ' << recorded.pair;
      EXPECT_EQ(touch_by_simplex(recorded.pair), *recorded.touch) << recorded.source << ' ' << recorded.pair;
    }
  }
}

}  // namespace peerd::oracle::oracle_test
