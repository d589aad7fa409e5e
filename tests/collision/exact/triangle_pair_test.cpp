#include "collision/exact/triangle_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "collision/exact/expansion.hpp"
#include "tests/oracle/triangle_cases.hpp"
#include "tests/oracle/triangle_oracle.hpp"
#include "tests/oracle/tritri_files.hpp"

namespace peerd::collision::triangle_pair_test {

Vec3 to_vec3(const oracle::Point& p) { return {p[0], p[1], p[2]}; }
Triangle to_triangle(const oracle::Triangle& t) { return {to_vec3(t[0]), to_vec3(t[1]), to_vec3(t[2])}; }

bool touch(const oracle::Pair& pair) {
  OrientationCounters counters;
  return touch(to_triangle(pair.a), to_triangle(pair.b), counters);
}

std::string text_of(const oracle::Pair& pair) {
  std::string text;
  for (const oracle::Triangle* t : {&pair.a, &pair.b}) {
    for (const oracle::Point& p : *t) {
      for (const double x : p) {
        std::array<char, 32> buffer{};
        std::snprintf(buffer.data(), buffer.size(), "%a ", x);
        text += buffer.data();
      }
    }
  }
  return text;
}

// A hundredth of what the benchmark `collision_exact` runs.
void compare(std::span<const oracle::Generator> generators, int pairs_each) {
  for (const oracle::Generator& generator : generators) {
    oracle::Rng rng(20);
    for (int i = 0; i < pairs_each; ++i) {
      const oracle::Pair pair = generator.make(rng);
      ASSERT_EQ(touch(pair), oracle::touch(pair.a, pair.b)) << generator.name << ": " << text_of(pair);
    }
  }
}

TEST(TrianglePair, AgreesWithTheOracleOnGeneralPairs) { compare(oracle::general(), 10'000); }
TEST(TrianglePair, AgreesWithTheOracleOnAdversarialPairs) { compare(oracle::adversarial(), 300); }

TEST(TrianglePair, All72OrdersGiveOneAnswer) {
  constexpr std::array<std::array<std::size_t, 3>, 6> kOrders = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (const auto generators : {oracle::general(), oracle::adversarial()}) {
    for (const oracle::Generator& generator : generators) {
      oracle::Rng rng(21);
      for (int i = 0; i < 20; ++i) {
        const oracle::Pair pair = generator.make(rng);
        const bool expected = oracle::touch(pair.a, pair.b);
        for (const auto& p : kOrders) {
          for (const auto& q : kOrders) {
            const oracle::Triangle a = {pair.a[p[0]], pair.a[p[1]], pair.a[p[2]]};
            const oracle::Triangle b = {pair.b[q[0]], pair.b[q[1]], pair.b[q[2]]};
            ASSERT_EQ(touch({a, b}), expected) << generator.name << ": " << text_of({a, b});
            ASSERT_EQ(touch({b, a}), expected) << generator.name << ": " << text_of({b, a});
          }
        }
      }
    }
  }
}

TEST(TrianglePair, AgreesWithRecordedAnswers) {
  const char* const corpus = std::getenv("PEERD_CORPUS");
  if (corpus == nullptr) GTEST_SKIP() << "PEERD_CORPUS is not set";
  for (const auto& read : {oracle::read_regression_pairs(corpus), oracle::read_shen2003_pairs(corpus)}) {
    ASSERT_TRUE(read.has_value()) << read.error();
    for (const oracle::RecordedPair& recorded : *read) {
      const bool expected = recorded.touch.value_or(oracle::touch(recorded.pair.a, recorded.pair.b));
      EXPECT_EQ(touch(recorded.pair), expected) << recorded.source;
    }
  }
}

TEST(TrianglePair, TheFilterAnswersGeneralPairs) {
  OrientationCounters counters;
  int pairs = 0;
  for (const oracle::Generator& generator : oracle::general()) {
    if (generator.name.starts_with("lattice")) continue;  // made for touches
    oracle::Rng rng(22);
    for (int i = 0; i < 10'000; ++i, ++pairs) {
      const oracle::Pair pair = generator.make(rng);
      (void)touch(to_triangle(pair.a), to_triangle(pair.b), counters);
    }
  }
  EXPECT_LE(counters.exact * 10'000, static_cast<std::uint64_t>(pairs));
}

// The stages behind the filter, each reached: exact differences, tails, the full expansion, integers.
TEST(Orientation, EachStageGivesTheSignOfTheRealDeterminant) {
  OrientationCounters counters;
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(volume_sign_exact(a, b, c, {0.25, 0.25, 0x1p-60}, counters), 1);
  EXPECT_EQ(volume_sign_exact(a, b, c, {0.25, 0.25, 0}, counters), 0);
  // Four points of the plane x + y + z = 0 with coordinates of 53 bits, and one moved by an ulp.
  const auto on_plane = [](double p, double q) { return Vec3(p, q, -(p + q)); };
  const Vec3 d = on_plane(0x1.5p-3, 0x1.7p-4), e = on_plane(0x1.1p-2, -0x1.3p-1), f = on_plane(-0x1.9p-5, 0x1.fp-2);
  EXPECT_EQ(volume_sign_exact(d, e, f, on_plane(0x1.23p-7, 0x1.45p-3), counters), 0);
  Vec3 off = on_plane(0x1.23p-7, 0x1.45p-3);
  const int up = volume_sign(d, e, f, off + Vec3(0, 0, 1), counters);
  off[2] = std::nextafter(off[2], 1.0);
  EXPECT_EQ(volume_sign_exact(d, e, f, off, counters), up);
  EXPECT_EQ(counters.wide, 0u);
  // x + y + z = 2^-60 at each corner but the last, in differences that binary64 can't hold: the tails decide.
  const Vec3 g(1, 0x1p-60, -1), h(0x1p-60, 1, -1), i(-1, 1, 0x1p-60);
  EXPECT_EQ(volume_sign_exact(g, h, i, {1, -1, 0x1p-60}, counters), 0);
  EXPECT_EQ(volume_sign_exact(g, h, i, {1, -1, 0x1p-59}, counters), 1);
  EXPECT_EQ(volume_sign_exact(g, h, i, {1, -1, 0}, counters), -1);
  EXPECT_EQ(counters.wide, 0u);
  // A denormal height over a face of 1e300.
  EXPECT_EQ(volume_sign_exact(a, {1e300, 0, 0}, {0, 1e300, 0}, {1, 1, 5e-324}, counters), 1);
  EXPECT_GT(counters.wide, 0u);
}

TEST(Expansion, SumsAndProductsKeepEveryBit) {
  const Expansion<2> third(two_difference(1.0, 0x1p-80));  // 1 - 2^-80
  const Expansion<8> square = product(third, third);       // 1 - 2^-79 + 2^-160
  const Expansion<2> one(TwoTerms{1.0, 0.0});
  const Expansion<10> rest = difference(square, one);
  ASSERT_EQ(rest.size(), 2u);
  EXPECT_EQ(rest[0], 0x1p-160);
  EXPECT_EQ(rest[1], -0x1p-79);
  EXPECT_EQ(rest.sign(), -1);
  const Expansion<12> least = sum(rest, Expansion<2>(TwoTerms{0x1p-79, 0.0}));
  ASSERT_EQ(least.size(), 1u);
  EXPECT_EQ(least[0], 0x1p-160);
  EXPECT_EQ(difference(square, square).sign(), 0);
}

}  // namespace peerd::collision::triangle_pair_test
