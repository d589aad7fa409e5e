#include "core/vrml/diagnostics.hpp"

#include <algorithm>

namespace peerd {
namespace {

constexpr std::size_t kExcerptBytes = 160;  // of a source line

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }
bool is_utf8_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

std::string printable(std::string_view text) {
  std::string out(text);
  std::ranges::replace_if(out, is_control, '?');
  return out;
}

}  // namespace

std::string render(const Diagnostic& diagnostic, std::string_view file_name, std::string_view text) {
  const std::size_t at = std::min(diagnostic.offset, text.size());
  std::size_t begin = at;
  while (begin > 0 && text[begin - 1] != '\n' && text[begin - 1] != '\r' && at - begin < kExcerptBytes / 2) --begin;
  while (begin < at && is_utf8_continuation(text[begin])) ++begin;
  std::size_t end = at;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r' && end - begin < kExcerptBytes) ++end;
  while (end < text.size() && end > at && is_utf8_continuation(text[end])) --end;

  std::string out(file_name);
  out += ':' + std::to_string(diagnostic.where.line) + ':' + std::to_string(diagnostic.where.column);
  out += diagnostic.severity == Severity::kError ? ": error: " : ": warning: ";
  out += diagnostic.message + '\n' + printable(text.substr(begin, end - begin)) + '\n';
  for (const char c : text.substr(begin, at - begin)) {
    if (!is_utf8_continuation(c)) out += c == '\t' ? '\t' : ' ';
  }
  return out + "^\n";
}

namespace vrml {

void Problems::error(const Spot& spot, std::string message) {
  if (full()) return;
  ++errors_;
  if (full()) message += "; the reader stops here, after " + std::to_string(kLimit) + " errors";
  add({Severity::kError, spot.where, std::move(message), spot.offset});
}

void Problems::warning(const Spot& spot, std::string message) {
  if (warnings_ >= kLimit) return;
  ++warnings_;
  if (warnings_ == kLimit) message += "; further warnings are not shown";
  add({Severity::kWarning, spot.where, std::move(message), spot.offset});
}

// Kept in the order of the text; at one place, in the order they came.
void Problems::add(Diagnostic diagnostic) {
  list_.insert(std::ranges::upper_bound(list_, diagnostic.offset, {}, &Diagnostic::offset), std::move(diagnostic));
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::size_t shown = std::min(text.size(), kShown);
  while (shown < text.size() && shown > 0 && is_utf8_continuation(text[shown])) --shown;
  return "'" + printable(text.substr(0, shown)) + (shown < text.size() ? "...'" : "'");
}

std::string did_you_mean(const Suggestion& suggestion) {
  const auto best = suggestion.best();
  return best ? ", did you mean " + quoted(*best) + "?" : "";
}

}  // namespace vrml
}  // namespace peerd
