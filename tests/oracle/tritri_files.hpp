#pragma once
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/oracle/triangle_cases.hpp"

namespace peerd::oracle {

struct RecordedPair {
  Pair pair;
  std::optional<bool> touch;  // what the file says, where it says so
  std::string source;         // the comment before the pair, or the file's name
};
using RecordedPairs = std::expected<std::vector<RecordedPair>, std::string>;  // or FILE:LINE: what is wrong

// `folder` holds ccd/regression_tritri.txt: 18 numbers a pair, a0 a1 a2 b0 b1 b2. A # line is about the next pair, and
// has TRUE, FALSE or "false positive" where the answer is known.
[[nodiscard]] RecordedPairs read_regression_pairs(const std::filesystem::path& folder);

// `folder` holds ccd/shen2003/intersected.txt and separated.txt: the answer is the name.
[[nodiscard]] RecordedPairs read_shen2003_pairs(const std::filesystem::path& folder);

}  // namespace peerd::oracle
