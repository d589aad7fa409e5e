#include "peerd/cli/program/help_topics.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace peerd {
namespace {

constexpr std::string_view kFence = "```", kEmphasis = "**", kComment = "<!--";

// The first line without its line end; `text` begins after it.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

// "[words](target)" at the begin of the text: its words.
std::optional<std::string_view> link_words(std::string_view text) {
  const std::size_t middle = text.find("](");
  if (!text.starts_with('[') || middle == std::string_view::npos || text.substr(1, middle - 1).contains('[')) return {};
  if (text.find(')', middle) == std::string_view::npos) return {};
  return text.substr(1, middle - 1);
}

std::string plain_line(std::string_view line) {
  std::string plain;
  while (!line.empty()) {
    if (const auto words = link_words(line)) {
      plain += *words;
      line.remove_prefix(line.find(')', words->size()) + 1);
    } else if (line.starts_with(kEmphasis)) {
      line.remove_prefix(kEmphasis.size());
    } else {
      plain += line.front();
      line.remove_prefix(1);
    }
  }
  return plain;
}

std::string_view title_of(const HelpPage& page) {
  std::string_view text = page.text;
  const std::string_view line = take_line(text);
  return line.substr(std::min(line.find_first_not_of("# "), line.size()));
}

}  // namespace

std::string plain_text_of(std::string_view markdown) {
  std::string plain;
  bool is_code = false;
  while (!markdown.empty()) {
    const std::string_view line = take_line(markdown);
    if (line.starts_with(kFence)) {
      is_code = !is_code;
    } else if (is_code) {
      plain += line.empty() ? "\n" : fmt::format("    {}\n", line);
    } else if (!line.starts_with(kComment)) {
      plain += plain_line(line) + '\n';
    }
  }
  return plain;
}

std::string list_of_topics(std::span<const HelpPage> pages) {
  std::string list;
  for (const HelpPage& page : pages) list += fmt::format("  {:<20}{}\n", page.name, title_of(page));
  return list;
}

std::optional<std::string> help_on(std::string_view topic, std::span<const HelpPage> pages) {
  const auto page = std::ranges::find(pages, topic, &HelpPage::name);
  return page == pages.end() ? std::nullopt : std::optional(plain_text_of(page->text));
}

}  // namespace peerd
