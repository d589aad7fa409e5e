#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// VRML97 text in lines of about kWidth columns, two blanks deeper in each node and list.
class TextWriter {
 public:
  static constexpr std::size_t kWidth = 100;

  // A line that `text` begins; more may follow.
  void begin_line(std::string_view text) {
    out_.append(2 * depth_, ' ');
    out_ += text;
  }
  void add(std::string_view text) { out_ += text; }
  void end_line() { out_ += '\n'; }
  void line(std::string_view text) {
    begin_line(text);
    end_line();
  }
  void open(std::string_view text) {  // '{' or '[' behind what the line has
    out_ += text;
    end_line();
    ++depth_;
  }
  void close(std::string_view text) {
    --depth_;
    line(text);
  }

  // Writes a value of any type but nodes behind the name of its field, and ends the line.
  void value(const Field& field);
  void strings(std::span<const std::string> texts);

  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  void number(float value);
  void number(double value);
  void number(std::int32_t value);
  void image(std::span<const std::int32_t> image);
  // Elements 0 to `count` in brackets, on this line or on lines of their own; `add_one` appends element i to out_, and
  // `closes` says whether a group that is to stay on one line ends with it.
  template <class AddOne, class Closes>
  void list(std::size_t count, AddOne add_one, Closes closes, std::string_view between_groups);

  std::string out_;
  std::size_t depth_ = 0;
};

// Writes text in quotes, with \" and \\ for the characters that end a string and escape.
[[nodiscard]] std::string string_text(std::string_view value);

}  // namespace peerd::vrml
