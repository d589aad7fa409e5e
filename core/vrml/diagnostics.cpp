#include "core/vrml/diagnostics.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace peerd {
namespace {

constexpr std::size_t kExcerptBytes = 160;  // of a source line
constexpr std::size_t kLongestName = 64;    // that suggestions are made for

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }
bool is_utf8_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string printable(std::string_view text) {
  std::string out(text);
  std::ranges::replace_if(out, is_control, '?');
  return out;
}

// Letters to insert, delete or replace, neighbours swapped counting as one ("optimal string alignment"). Case is free:
// VRML words differ from each other by more than case.
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

Suggestion::Suggestion(std::string_view word)
    : word_(word), best_distance_(word.size() > kLongestName ? 0 : std::max<std::size_t>(word.size() / 3, 1) + 1) {}

void Suggestion::consider(std::string_view candidate) {
  const auto [shorter, longer] = std::minmax({word_.size(), candidate.size()});
  if (longer > kLongestName || longer - shorter >= best_distance_) return;
  const std::size_t distance = edit_distance(word_, candidate);
  if (distance >= best_distance_ || distance >= longer) return;
  best_distance_ = distance;
  best_ = candidate;
}

std::string Suggestion::text() const { return best_.empty() ? "" : ", did you mean " + quoted(best_) + "?"; }

}  // namespace vrml
}  // namespace peerd
