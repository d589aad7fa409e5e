#include "bench/exact/pairs.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "collision/exact/triangle_pair.hpp"
#include "tests/oracle/tritri_files.hpp"

namespace peerd::bench::exact {
namespace {

constexpr std::uint64_t kBatch = 1024;           // pairs between two looks at the clock
constexpr std::uint64_t kPairsToPermute = 1000;  // of so many, the first is asked in all orders
constexpr int kMostPrinted = 3;                  // wrong pairs of a generator

// The processor's time: whoever else runs only makes waits.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct OurPair {
  collision::Triangle a, b;
};

Vec3 vec3(const oracle::Point& p) { return {p[0], p[1], p[2]}; }
OurPair ours(const oracle::Pair& pair) {
  return {{vec3(pair.a[0]), vec3(pair.a[1]), vec3(pair.a[2])}, {vec3(pair.b[0]), vec3(pair.b[1]), vec3(pair.b[2])}};
}

void print_pair(const std::string& name, const oracle::Pair& pair, bool truth) {
  std::printf("WRONG: %s, should be %d:", name.c_str(), truth);
  for (const oracle::Triangle* triangle : {&pair.a, &pair.b}) {
    for (const oracle::Point& p : *triangle) std::printf(" {%a, %a, %a}", p[0], p[1], p[2]);
  }
  std::printf("\n");
}

// The 72 orders: 6 of each triangle's corners, and which triangle is the first.
void ask_in_all_orders(const OurPair& pair, bool truth, collision::OrientationCounters& counters, PairResult& result) {
  std::array<std::size_t, 3> i = {0, 1, 2};
  do {
    const collision::Triangle a = {pair.a[i[0]], pair.a[i[1]], pair.a[i[2]]};
    std::array<std::size_t, 3> j = {0, 1, 2};
    do {
      const collision::Triangle b = {pair.b[j[0]], pair.b[j[1]], pair.b[j[2]]};
      result.permuted += 2;
      result.wrong_permuted += collision::touch(a, b, counters) != truth;
      result.wrong_permuted += collision::touch(b, a, counters) != truth;
    } while (std::ranges::next_permutation(j).found);
  } while (std::ranges::next_permutation(i).found);
}

}  // namespace

PairResult check_generator(const oracle::Generator& generator, std::uint64_t seed, std::uint64_t pairs) {
  PairResult result{.name = std::string(generator.name)};
  collision::OrientationCounters counters, uncounted;
  oracle::Rng rng(seed);
  std::vector<oracle::Pair> batch;
  std::vector<OurPair> our_batch;
  std::vector<char> answers, truths;
  while (result.pairs < pairs) {
    batch.clear();
    our_batch.clear();
    answers.clear();
    truths.clear();
    for (std::uint64_t i = result.pairs; i < pairs && batch.size() < kBatch; ++i) {
      batch.push_back(generator.make(rng));
      our_batch.push_back(ours(batch.back()));
    }
    const double begin = cpu_seconds();
    for (const OurPair& pair : our_batch) answers.push_back(collision::touch(pair.a, pair.b, counters));
    const double between = cpu_seconds();
    for (const oracle::Pair& pair : batch) truths.push_back(oracle::touch(pair.a, pair.b));
    result.ours_s += between - begin;
    result.oracle_s += cpu_seconds() - between;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const bool truth = truths[i] != 0;
      result.touching += truth;
      if (answers[i] != truths[i] && ++result.wrong <= kMostPrinted) print_pair(result.name, batch[i], truth);
      if ((result.pairs + i) % kPairsToPermute == 0) ask_in_all_orders(our_batch[i], truth, uncounted, result);
    }
    result.pairs += batch.size();
  }
  result.exact = counters.exact;
  result.wide = counters.wide;
  return result;
}

std::vector<PairResult> check_recorded(const std::string& folder) {
  std::vector<PairResult> results;
  for (const auto read : {oracle::read_regression_pairs, oracle::read_shen2003_pairs}) {
    PairResult result{.name = read == oracle::read_regression_pairs ? "regression_tritri" : "shen2003"};
    const oracle::RecordedPairs pairs = read(folder);
    if (!pairs) {
      std::fprintf(stderr, "error: %s\n", pairs.error().c_str());
      result.wrong = 1;
    }
    collision::OrientationCounters counters;
    for (const oracle::RecordedPair& recorded : pairs.value_or(std::vector<oracle::RecordedPair>())) {
      const bool truth = oracle::touch(recorded.pair.a, recorded.pair.b);
      const OurPair pair = ours(recorded.pair);
      const bool answer = collision::touch(pair.a, pair.b, counters);
      ++result.pairs;
      result.touching += truth;
      if (answer != truth || answer != recorded.touch.value_or(answer)) {
        ++result.wrong;
        print_pair(recorded.source, recorded.pair, truth);
      }
      ask_in_all_orders(pair, truth, counters, result);
    }
    result.exact = counters.exact;
    result.wide = counters.wide;
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace peerd::bench::exact
