#include "tests/oracle/tritri_files.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>

namespace peerd::oracle {
namespace {

std::optional<bool> answer_in(std::string_view comment) {
  if (comment.contains("TRUE")) return true;
  if (comment.contains("FALSE") || comment.contains("false positive")) return false;
  return std::nullopt;
}

// Both formats: numbers, 18 a pair however they are broken into lines, and comments.
RecordedPairs read_pairs(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::unexpected(path.string() + ": cannot be read");
  std::vector<RecordedPair> pairs;
  RecordedPair next;
  std::size_t coordinates = 0, line_number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string place = path.string() + ":" + std::to_string(++line_number) + ": ";
    if (line.starts_with('#')) {
      if (coordinates != 0) return std::unexpected(place + "a comment within a pair");
      next.touch = answer_in(line);
      next.source = line.substr(1);
      continue;
    }
    constexpr std::string_view kBlanks = " \t\r";
    for (std::string_view rest = line;;) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
      if (rest.empty()) break;
      double value = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      if (error != std::errc{} || !std::isfinite(value))
        return std::unexpected(place + "not a number: " + std::string(rest));
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
      (coordinates < 9 ? next.pair.a : next.pair.b)[coordinates % 9 / 3][coordinates % 3] = value;
      if (++coordinates == 18) {
        pairs.push_back(std::exchange(next, {}));
        coordinates = 0;
      }
    }
  }
  if (coordinates != 0) return std::unexpected(path.string() + ": ends within a pair");
  return pairs;
}

}  // namespace

RecordedPairs read_regression_pairs(const std::filesystem::path& folder) {
  return read_pairs(folder / "ccd" / "regression_tritri.txt");
}

RecordedPairs read_shen2003_pairs(const std::filesystem::path& folder) {
  std::vector<RecordedPair> all;
  for (const bool touch : {true, false}) {
    const std::string name = touch ? "intersected.txt" : "separated.txt";
    RecordedPairs pairs = read_pairs(folder / "ccd" / "shen2003" / name);
    if (!pairs) return pairs;
    for (RecordedPair& recorded : *pairs) {
      recorded.touch = touch;
      recorded.source = name;
      all.push_back(std::move(recorded));
    }
  }
  return all;
}

}  // namespace peerd::oracle
