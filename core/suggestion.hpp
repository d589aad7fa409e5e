#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace peerd {

// A Suggestion finds the candidate nearest to a misspelt word: same letters but for case, the word with a unit such as
// _ms behind it, or at most a third of the letters wrong. The word and the candidates must outlive it.
class Suggestion {
 public:
  explicit Suggestion(std::string_view word);
  void consider(std::string_view candidate);
  [[nodiscard]] std::optional<std::string_view> best() const;

 private:
  std::string_view word_;
  std::string_view best_;
  std::size_t best_distance_;  // better than this counts
};

}  // namespace peerd
