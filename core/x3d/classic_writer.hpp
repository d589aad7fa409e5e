#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "core/vrml/diagnostics.hpp"
#include "core/x3d/classic_text.hpp"

namespace peerd::vrml {

// A ClassicWriter writes in the Classic VRML encoding what a file in XML says, and notes where it stands there. Offsets
// are those of the file in XML, which stands at `begin` among the texts of the world.
class ClassicWriter {
 public:
  ClassicWriter(Position begin, Problems& problems) : begin_(begin), problems_(problems) {}

  // Writes a word or a sign of the language, with a blank behind it.
  void word(std::string_view word, std::size_t at);
  // Writes a name, whatever its bytes are.
  void name(std::string_view raw, std::size_t at);
  void line() { made_.text += '\n'; }
  // Writes a value of a field of that type, which XML has as `raw` at `at`. Returns whether it is one; where not, it
  // has reported that and has written nothing. `field` is the field's name, for people.
  bool value(std::string_view type, std::string_view field, std::string_view raw, std::size_t at);
  // Writes a string, which is there as it is, without quotes and escapes.
  void source(std::string_view text, std::size_t at);
  // Writes the value that a field of that type has where a declaration gives none.
  void default_value(std::string_view type, std::size_t at);

  // Returns the text behind XML's entities.
  [[nodiscard]] std::string decoded(std::string_view raw, std::size_t at);

  void fault(std::size_t at, std::string message, std::string_view reading) {
    problems_.fault(position(at), std::move(message), reading);
  }
  void error(std::size_t at, std::string message) { problems_.error(position(at), std::move(message)); }
  void warning(std::size_t at, std::string message) { problems_.warning(position(at), std::move(message)); }
  [[nodiscard]] std::size_t size() const { return made_.text.size(); }
  // Takes back what was written since the text had that size.
  void cut(std::size_t size) {
    made_.text.resize(size);
    made_.map.cut(size);
  }
  [[nodiscard]] ClassicText take() { return std::move(made_); }

 private:
  [[nodiscard]] Position position(std::size_t at) const { return begin_ + static_cast<Position>(at); }
  void string(std::string_view text);
  bool strings(std::string_view field, std::string_view raw, std::size_t at);
  bool flags(std::string_view type, std::string_view field, std::string_view raw, std::size_t at);
  bool numbers(std::string_view type, std::string_view field, std::string_view raw, std::size_t at);

  Position begin_;
  Problems& problems_;
  ClassicText made_;
};

}  // namespace peerd::vrml
