#pragma once
#include <string>
#include <string_view>

#include "peerd/lab/report/figure_json.hpp"

namespace peerd::report {

// The style sheet and the script of a page: report.css, and figures.js with report.js, which CMake puts into the
// program.
extern const std::string_view kPageStyle, kPageScript;

// An HTML element; `tag` may have attributes.
[[nodiscard]] std::string element(std::string_view tag, std::string_view content);

// A script element of that class that holds data for the page's script.
[[nodiscard]] std::string data_element(std::string_view name, const Json& data);

// A figure with its description, which is markup. The script draws it, and saves it as a file of that name.
[[nodiscard]] std::string figure_markup(const Json& figure, std::string_view name, std::string_view caption);

// A whole page that needs nothing but itself. `body` is markup.
[[nodiscard]] std::string page_around(std::string_view title, std::string_view body);

}  // namespace peerd::report
