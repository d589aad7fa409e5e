#include "peerd/net/doctor/finding.hpp"

#include <algorithm>
#include <string_view>

#include <spdlog/fmt/fmt.h>

namespace peerd::doctor {
namespace {

std::string_view word_of(Level level) {
  switch (level) {
    case Level::kGood:
      return "good";
    case Level::kHint:
      return "hint";
    case Level::kWarning:
      return "warning";
    case Level::kProblem:
      return "problem";
  }
  return "";
}

}  // namespace

int exit_code_of(std::span<const Finding> findings) {
  const auto has = [&](Level level) { return std::ranges::find(findings, level, &Finding::level) != findings.end(); };
  return has(Level::kProblem) ? 3 : has(Level::kWarning) ? 1 : 0;
}

std::string as_text(std::span<const Finding> findings) {
  std::string text;
  for (const Finding& f : findings) {
    const std::string level = f.level == Level::kGood ? "" : fmt::format("{}: ", word_of(f.level));
    text += fmt::format("{:<16}{}{}{}{}\n", f.name, level, f.sentence, f.advice.empty() ? "" : "; ", f.advice);
  }
  return text;
}

nlohmann::ordered_json as_json(std::span<const Finding> findings) {
  auto all = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    all.push_back({{"name", f.name}, {"level", word_of(f.level)}, {"sentence", f.sentence}, {"advice", f.advice}});
  }
  return all;
}

}  // namespace peerd::doctor
