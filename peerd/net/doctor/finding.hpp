#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::doctor {

// The weight of a finding for peers with the settings that were examined.
enum class Level : std::uint8_t {
  kGood,     // it was seen to work
  kHint,     // it may matter, or could not be seen
  kWarning,  // it keeps peers on other computers from being heard, or will hurt
  kProblem,  // no peer could work with it
};

struct Finding {
  std::string name;  // "mtu"
  Level level = Level::kGood;
  std::string sentence;
  std::string advice = {};  // what to do about it; empty: nothing
};

// The exit code is 3 with a problem, 1 with a warning, else 0.
[[nodiscard]] int exit_code_of(std::span<const Finding> findings);

// The text has one line for each finding.
[[nodiscard]] std::string as_text(std::span<const Finding> findings);
// The array is [{name, level, sentence, advice}], with level "good", "hint", "warning" or "problem".
[[nodiscard]] nlohmann::ordered_json as_json(std::span<const Finding> findings);

}  // namespace peerd::doctor
