#include "collision/exact/triangle_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "collision/exact/expansion.hpp"
#include "tests/collision/oracle_types.hpp"
#include "tests/oracle/triangle_cases.hpp"
#include "tests/oracle/tritri_files.hpp"

namespace peerd::collision::triangle_pair_test {

bool touch(const oracle::Pair& pair) {
  OrientationCounters counters;
  return touch(ours(pair.a), ours(pair.b), counters);
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
      (void)touch(ours(pair.a), ours(pair.b), counters);
    }
  }
  EXPECT_LE(counters.exact * 10'000, static_cast<std::uint64_t>(pairs));
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
