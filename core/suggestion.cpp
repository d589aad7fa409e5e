#include "core/suggestion.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>

namespace peerd {
namespace {

constexpr std::size_t kLongestName = 64;  // longer words are no misspelt names

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Returns the number of letters to insert, delete or replace, neighbours swapped counting as one ("optimal string
// alignment"). Case is free: names differ from each other by more than case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  assert(a.size() <= kLongestName && b.size() <= kLongestName);
  std::array<std::array<std::uint8_t, kLongestName + 1>, 3> rows;
  std::iota(rows[0].begin(), rows[0].end(), std::uint8_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    auto& row = rows[i % 3];
    const auto& above = rows[(i + 2) % 3];
    const auto& above2 = rows[(i + 1) % 3];
    row[0] = static_cast<std::uint8_t>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int differs = lower(a[i - 1]) != lower(b[j - 1]);
      int best = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + differs});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) best = std::min(best, above2[j - 2] + 1);
      row[j] = static_cast<std::uint8_t>(best);
    }
  }
  return rows[a.size() % 3][b.size()];
}

// Whether the candidate is the word with a unit behind it, such as latency_ms for latency.
bool lacks_unit(std::string_view word, std::string_view candidate) {
  return !word.empty() && candidate.size() > word.size() && candidate[word.size()] == '_' &&
         std::ranges::equal(word, candidate.substr(0, word.size()), {}, lower, lower);
}

}  // namespace

Suggestion::Suggestion(std::string_view word)
    : word_(word), best_distance_(word.size() > kLongestName ? 0 : std::max<std::size_t>(word.size() / 3, 1) + 1) {}

void Suggestion::consider(std::string_view candidate) {
  if (best_distance_ > 1 && lacks_unit(word_, candidate)) {
    best_distance_ = 1;
    best_ = candidate;
  }
  const auto [shorter, longer] = std::minmax({word_.size(), candidate.size()});
  if (longer > kLongestName || longer - shorter >= best_distance_) return;
  const std::size_t distance = edit_distance(word_, candidate);
  if (distance >= best_distance_ || distance >= longer) return;
  best_distance_ = distance;
  best_ = candidate;
}

std::optional<std::string_view> Suggestion::best() const {
  if (best_.empty()) return std::nullopt;
  return best_;
}

}  // namespace peerd
