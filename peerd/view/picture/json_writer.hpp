#pragma once
#include <charconv>
#include <cmath>
#include <concepts>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd::view {

// Appends JSON to a text, without a tree of it: a picture has hundreds of thousands of nodes. The caller opens and
// closes in pairs.
class JsonWriter {
 public:
  JsonWriter() = default;
  // Goes on behind a key, or behind a value within a list or an object.
  explicit JsonWriter(std::string begun) : out_(std::move(begun)), first_(false) {}

  JsonWriter& open(char bracket) {
    comma();
    out_ += bracket;
    first_ = true;
    return *this;
  }
  JsonWriter& close(char bracket) {
    out_ += bracket;
    first_ = false;
    return *this;
  }
  JsonWriter& key(std::string_view name) {  // plain letters
    comma();
    out_ += '"';
    out_ += name;
    out_ += "\":";
    first_ = true;
    return *this;
  }
  // Bytes that are not UTF-8 are replaced.
  JsonWriter& value(std::string_view text) {
    comma();
    out_ += json_line(nlohmann::json(text));
    return *this;
  }
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  template <class Number>
  requires std::integral<Number> || std::floating_point<Number> JsonWriter& value(Number number) {
    comma();
    if constexpr (std::same_as<Number, bool>) {
      out_ += number ? "true" : "false";
    } else {
      if constexpr (std::floating_point<Number>) {
        if (!std::isfinite(number)) {
          out_ += "null";
          return *this;
        }
      }
      char digits[40];
      out_.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
    }
    return *this;
  }
  template <class Value>
  JsonWriter& member(std::string_view name, const Value& each) {
    return key(name).value(each);
  }
  template <class Range>
  JsonWriter& list(std::string_view name, const Range& range) {
    key(name).open('[');
    for (const auto& each : range) value(each);
    return close(']');
  }

  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  void comma() {
    if (!first_) out_ += ',';
    first_ = false;
  }
  std::string out_;
  bool first_ = true;
};

}  // namespace peerd::view
