#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene.hpp"
#include "core/suggestion.hpp"

namespace peerd {

enum class Severity : std::uint8_t { kWarning, kError };

struct Diagnostic {
  Severity severity = Severity::kError;
  SourceLocation where;
  std::string message;
  std::size_t offset = 0;  // the same place as `where`, in bytes from the beginning of the text
};

// FILE:LINE:COLUMN: error: MESSAGE
// the source line (control bytes as '?', a long line cut around the place)
//    ^
[[nodiscard]] std::string render(const Diagnostic& diagnostic, std::string_view file_name, std::string_view text);

namespace vrml {

// A place in the text: what a person reads and what finds it again.
struct Spot {
  std::size_t offset = 0;
  SourceLocation where{1, 1};
};

// Everything that is wrong with one text. Past kLimit errors the list is closed with a last entry that says so, and the
// parser stops: a binary file by mistake must not cost minutes and gigabytes of messages.
class Problems {
 public:
  static constexpr std::size_t kLimit = 1000;

  void error(const Spot& spot, std::string message);
  void warning(const Spot& spot, std::string message);
  [[nodiscard]] bool full() const { return errors_ >= kLimit; }
  [[nodiscard]] std::size_t errors() const { return errors_; }
  // In the order of the text; leaves this empty.
  [[nodiscard]] std::vector<Diagnostic> take() { return std::exchange(list_, {}); }

 private:
  void add(Diagnostic diagnostic);

  std::vector<Diagnostic> list_;
  std::size_t errors_ = 0;
  std::size_t warnings_ = 0;
};

// What a message shows of the input: in quotes, control bytes as '?', shortened.
[[nodiscard]] std::string quoted(std::string_view text);

[[nodiscard]] std::string did_you_mean(const Suggestion& suggestion);  // ", did you mean 'Transform'?", or empty

}  // namespace vrml
}  // namespace peerd
