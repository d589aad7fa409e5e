#include "peerd/cli/shell/error_json.hpp"

#include <charconv>
#include <ostream>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

// Takes the number behind the last colon off the text. The result is 0 where there is none.
std::size_t take_number(std::string_view& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return 0;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data() + colon + 1, text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return 0;
  text.remove_suffix(text.size() - colon);
  return number;
}

Json entry(std::string_view file, std::size_t line, std::size_t column, std::string_view message) {
  return {{"file", file}, {"line", line}, {"column", column}, {"message", message}};
}

// Adds an entry for a line such as "FILE:LINE:COLUMN: error: MESSAGE", with or without its place.
void add_error(std::string_view line, Json& errors) {
  constexpr std::string_view kError = "error: ";
  const std::size_t at = line.starts_with(kError) ? 0 : line.find(": error: ");
  if (at == std::string_view::npos) return;
  std::string_view place = line.substr(0, at);
  const std::string_view message = line.substr(at == 0 ? kError.size() : at + 2 + kError.size());
  const std::size_t column = take_number(place), number = take_number(place);
  // FILE:LINE has no column.
  errors.push_back(number == 0 ? entry(place, column, 0, message) : entry(place, number, column, message));
}

}  // namespace

Json error_json(const InputError& error) {
  Json errors = Json::array();
  for (std::string_view rest = error.text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    add_error(rest.substr(0, end), errors);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (errors.empty()) errors.push_back(entry("", 0, 0, error.text));
  return {{"good", false}, {"errors", std::move(errors)}};
}

Json error_json(const ReadResult& result) {
  Json errors = Json::array();
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity != Severity::kError) continue;
    errors.push_back(entry(result.sources.at(d.source).name, d.where.line, d.where.column, d.message));
  }
  return {{"good", false}, {"errors", std::move(errors)}};
}

void print_error_json(const Json& json, std::ostream& out) { out << json_line(json) << '\n'; }

}  // namespace peerd
