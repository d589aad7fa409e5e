#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/suggestion.hpp"

namespace peerd {

struct SourceLocation {
  std::uint32_t line = 0;    // from 1; 0 in a file without lines
  std::uint32_t column = 0;  // from 1, in bytes; 0 in a file without lines
};

enum class Severity : std::uint8_t { kWarning, kError };

struct Diagnostic {
  Severity severity = Severity::kError;
  SourceLocation where;
  std::string message;
  std::uint32_t source = 0;  // the text, as an index into ReadResult::sources
  std::size_t offset = 0;    // offset of `where` in that text, in bytes
  bool is_fault = false;     // a lenient reading reads on from it (Problems::fault)
};

// FILE:LINE:COLUMN: error: MESSAGE
// the source line (control bytes as '?', a long line cut around the place)
//    ^
// In a file without lines, the result is FILE: error: MESSAGE.
[[nodiscard]] std::string render(const Diagnostic& diagnostic, std::string_view file_name, std::string_view text);

// The kinds of text, by how a place in one is shown: by line and column, or not at all in bytes that nobody reads.
enum class TextKind : std::uint8_t { kVrml, kLines, kBinary };

// A Source is one of the files that a world is made of: its own, that of an Inline or an EXTERNPROTO, or a buffer, an
// image or a list of materials that a world of another format names.
struct Source {
  std::string name;                          // for people; relative URLs start from it
  std::string_view text;                     // unpacked
  std::shared_ptr<const std::string> owned;  // keeps `text`; null where the caller of the reader keeps it
  TextKind kind = TextKind::kVrml;
};

namespace vrml {

// A Position is a byte of all texts of a world, laid one behind the other in the order in which they were opened.
using Position = std::uint32_t;

// Problems holds the texts, and the mistakes in them. Past kLimit errors the list is closed with a last entry that says
// so, and the parser stops: a binary file by mistake must not cost minutes and gigabytes of messages.
class Problems {
 public:
  static constexpr std::size_t kLimit = 1000;
  static constexpr std::uint64_t kMaxBytes = (std::uint64_t{1} << 32) - 2;  // Positions are 32 bits wide

  Problems() = default;
  explicit Problems(bool lenient) : lenient_(lenient) {}

  // Adds a text and returns the position of its first byte; nothing where the texts together would exceed kMaxBytes.
  [[nodiscard]] std::optional<Position> open(Source source);
  // The whole text that holds a position, and its begin. A scene that is made anew from its document has no texts: each
  // position is then the begin of an empty one.
  [[nodiscard]] std::string_view text_of(Position at) const;
  [[nodiscard]] Position begin_of(Position at) const;
  [[nodiscard]] std::string_view name_of(Position at) const;  // for the text that holds `at`
  [[nodiscard]] TextKind kind_of(Position at) const;          // of the text that holds `at`
  // Returns the name of the text and the offset in it: the same in every reading of the same files.
  [[nodiscard]] std::pair<std::string, std::size_t> place_of(Position at) const;

  void error(Position at, std::string message);
  void warning(Position at, std::string message);
  // Reports a departure from the standard that browsers read on from. It is an error; in a lenient reading it is a
  // warning which ends with `reading`, what is understood instead (docs/reference/lenient.md).
  void fault(Position at, std::string message, std::string_view reading);
  [[nodiscard]] bool lenient() const { return lenient_; }
  [[nodiscard]] std::size_t faults() const { return faults_; }
  [[nodiscard]] bool full() const { return errors_ >= kLimit; }
  [[nodiscard]] std::size_t errors() const { return errors_; }
  [[nodiscard]] std::string first_error() const;                // its message; there is one
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  // of all texts

  [[nodiscard]] std::vector<SourceLocation> locate(const std::vector<Position>& sorted) const;
  // Returns the diagnostics in the order of the texts, and leaves this object empty.
  struct Report {
    std::vector<Source> sources;
    std::vector<Diagnostic> diagnostics;
  };
  [[nodiscard]] Report take();

 private:
  struct Entry {
    Position at;
    Severity severity;
    std::string message;
    bool is_fault = false;
  };
  void add_error(Entry entry);
  void add_warning(Entry entry);
  [[nodiscard]] std::size_t source_at(Position at) const;
  // Returns whether the message is new: a mistake in a PROTO is there in each copy, and is reported once.
  [[nodiscard]] bool is_new(Position at, const std::string& message);

  std::vector<Source> sources_;
  std::vector<Position> begins_;  // begin of each source
  std::uint64_t bytes_ = 0;
  std::vector<Entry> list_;
  std::unordered_set<std::string> reported_;
  std::size_t errors_ = 0;
  std::size_t warnings_ = 0;
  std::size_t faults_ = 0;
  bool lenient_ = false;
};

// Returns text of the input as a message shows it: in quotes, control bytes as '?', shortened.
[[nodiscard]] std::string quoted(std::string_view text);

// No suggestion is looked for among more names than this: a misspelt one among millions must not cost minutes.
inline constexpr std::size_t kMaxSuggestionNames = 4096;

[[nodiscard]] std::string did_you_mean(const Suggestion& suggestion);  // ", did you mean 'Transform'?", or empty

}  // namespace vrml
}  // namespace peerd
