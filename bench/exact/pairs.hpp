#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/oracle/triangle_cases.hpp"

namespace peerd::bench::exact {

// A result holds what came of one generator's pairs, or of one file's.
struct PairResult {
  std::string name;
  std::uint64_t pairs = 0, touching = 0;
  std::uint64_t wrong = 0;                         // not as the oracle has it, or the file
  std::uint64_t permuted = 0, wrong_permuted = 0;  // each in one of the 72 orders
  std::uint64_t exact = 0, wide = 0;               // signs beyond the filter, and beyond expansions
  double ours_s = 0, oracle_s = 0;                 // for `pairs`
};

[[nodiscard]] PairResult check_generator(const oracle::Generator& generator, std::uint64_t seed, std::uint64_t pairs);
// The results are of the corpus's pairs with recorded answers; for a file that cannot be read, an error is printed and
// its result is wrong.
[[nodiscard]] std::vector<PairResult> check_recorded(const std::string& folder);

}  // namespace peerd::bench::exact
