#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace peerd {

// A page of docs/how-to, which is part of the program: its name, and its text in Markdown, "# TITLE" first.
struct HelpPage {
  std::string_view name, text;
};
[[nodiscard]] std::span<const HelpPage> help_pages();

// A page as a terminal shows it: without links' targets and marks of emphasis, code indented.
[[nodiscard]] std::string plain_text_of(std::string_view markdown);

// One line for each page: its name and its title.
[[nodiscard]] std::string list_of_topics(std::span<const HelpPage> pages);

// The page of that name, as a terminal shows it. None: there is no such page.
[[nodiscard]] std::optional<std::string> help_on(std::string_view topic, std::span<const HelpPage> pages);

}  // namespace peerd
