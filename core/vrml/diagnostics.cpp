#include "core/vrml/diagnostics.hpp"

#include <algorithm>
#include <cassert>

namespace peerd {
namespace {

constexpr std::size_t kExcerptBytes = 160;  // longest excerpt of a source line

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }
bool is_utf8_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

std::string printable(std::string_view text) {
  std::string out(text);
  std::ranges::replace_if(out, is_control, '?');
  return out;
}

}  // namespace

std::string render(const Diagnostic& diagnostic, std::string_view file_name, std::string_view text) {
  const std::string_view severity = diagnostic.severity == Severity::kError ? ": error: " : ": warning: ";
  if (diagnostic.where.line == 0)
    return std::string(file_name) + std::string(severity) + printable(diagnostic.message) + '\n';
  const std::size_t at = std::min(diagnostic.offset, text.size());
  std::size_t begin = at;
  while (begin > 0 && text[begin - 1] != '\n' && text[begin - 1] != '\r' && at - begin < kExcerptBytes / 2) --begin;
  while (begin < at && is_utf8_continuation(text[begin])) ++begin;
  std::size_t end = at;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r' && end - begin < kExcerptBytes) ++end;
  while (end < text.size() && end > at && is_utf8_continuation(text[end])) --end;

  std::string out(file_name);
  out += ':' + std::to_string(diagnostic.where.line) + ':' + std::to_string(diagnostic.where.column);
  out += severity;
  out += printable(diagnostic.message) + '\n' + printable(text.substr(begin, end - begin)) + '\n';
  for (const char c : text.substr(begin, at - begin)) {
    if (!is_utf8_continuation(c)) out += c == '\t' ? '\t' : ' ';
  }
  return out + "^\n";
}

namespace vrml {

std::optional<Position> Problems::open(Source source) {
  // The position behind the last byte of a text belongs to it, for what is missing at its end.
  if (bytes_ + source.text.size() + 1 > kMaxBytes) return std::nullopt;
  const auto begin = static_cast<Position>(bytes_);
  bytes_ += source.text.size() + 1;
  begins_.push_back(begin);
  sources_.push_back(std::move(source));
  return begin;
}

std::size_t Problems::source_at(Position at) const {
  assert(!begins_.empty());
  return static_cast<std::size_t>(std::ranges::upper_bound(begins_, at) - begins_.begin()) - 1;
}

std::string_view Problems::text_of(Position at) const {
  return sources_.empty() ? std::string_view() : sources_[source_at(at)].text;
}
std::string_view Problems::name_of(Position at) const { return sources_[source_at(at)].name; }
std::pair<std::string, std::size_t> Problems::place_of(Position at) const {
  const std::size_t source = source_at(at);
  return {sources_[source].name, at - begins_[source]};
}
TextKind Problems::kind_of(Position at) const {
  return sources_.empty() ? TextKind::kVrml : sources_[source_at(at)].kind;
}
Position Problems::begin_of(Position at) const { return sources_.empty() ? at : begins_[source_at(at)]; }

bool Problems::is_new(Position at, const std::string& message) {
  return reported_.insert(std::to_string(at) + message).second;
}

std::string Problems::first_error() const {
  const auto first = std::ranges::find(list_, Severity::kError, &Entry::severity);
  assert(first != list_.end());
  return first->message;
}

void Problems::add_error(Entry entry) {
  if (full() || !is_new(entry.at, entry.message)) return;
  ++errors_;
  faults_ += entry.is_fault ? 1 : 0;
  if (full()) entry.message += "; the reader stops here, after " + std::to_string(kLimit) + " errors";
  list_.push_back(std::move(entry));
}

void Problems::add_warning(Entry entry) {
  faults_ += entry.is_fault ? 1 : 0;
  if (warnings_ >= kLimit || !is_new(entry.at, entry.message)) return;
  ++warnings_;
  if (warnings_ == kLimit) entry.message += "; further warnings are not shown";
  list_.push_back(std::move(entry));
}

void Problems::error(Position at, std::string message) { add_error({at, Severity::kError, std::move(message)}); }
void Problems::warning(Position at, std::string message) { add_warning({at, Severity::kWarning, std::move(message)}); }

void Problems::fault(Position at, std::string message, std::string_view reading) {
  if (!lenient_) return add_error({at, Severity::kError, std::move(message), true});
  add_warning({at, Severity::kWarning, std::move(message) + "; " + std::string(reading), true});
}

// Reads all texts once. Lines end with LF, CR or CR LF.
std::vector<SourceLocation> Problems::locate(const std::vector<Position>& sorted) const {
  assert(std::ranges::is_sorted(sorted));
  std::vector<SourceLocation> out;
  out.reserve(sorted.size());
  std::size_t source = sources_.size(), at = 0, line_begin = 0, line_end = 0;  // line_end: known from `at` on
  std::uint32_t line = 1;
  for (const Position position : sorted) {
    const std::size_t here = source_at(position);
    if (sources_[here].kind == TextKind::kBinary) {
      out.push_back({});
      continue;
    }
    if (here != source) {
      source = here;
      at = line_begin = line_end = 0;
      line = 1;
    }
    const std::string_view text = sources_[source].text;
    const std::size_t offset = position - begins_[source];
    while (true) {
      if (line_end <= at) line_end = std::min(text.find_first_of("\n\r", at), text.size());
      if (line_end >= offset) break;
      at = line_end + (text.substr(line_end, 2) == "\r\n" ? 2 : 1);
      if (at > offset) break;  // inside a CR LF
      line_begin = at;
      ++line;
    }
    out.push_back({line, static_cast<std::uint32_t>(offset - line_begin + 1)});
  }
  return out;
}

Problems::Report Problems::take() {
  std::ranges::stable_sort(list_, {}, &Entry::at);
  std::vector<Position> positions;
  for (const Entry& entry : list_) positions.push_back(entry.at);
  const std::vector<SourceLocation> places = locate(positions);
  Report report;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const std::size_t source = source_at(list_[i].at);
    report.diagnostics.push_back({list_[i].severity, places[i], std::move(list_[i].message),
                                  static_cast<std::uint32_t>(source), list_[i].at - begins_[source],
                                  list_[i].is_fault});
  }
  report.sources = std::move(sources_);
  *this = {};
  return report;
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
