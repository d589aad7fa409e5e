#include "core/x3d/classic_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/vrml/lexer.hpp"
#include "core/vrml/node_types.hpp"

namespace peerd::vrml {
namespace {

bool is_xml_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool parts_values(char c) { return is_xml_blank(c) || c == ','; }

// Cuts a value into its words.
class ValueWords {
 public:
  explicit ValueWords(std::string_view text) : text_(text) {}
  [[nodiscard]] std::string_view next() {
    while (at_ < text_.size() && parts_values(text_[at_])) ++at_;
    begin_ = at_;
    while (at_ < text_.size() && !parts_values(text_[at_])) ++at_;
    return text_.substr(begin_, at_ - begin_);
  }
  [[nodiscard]] std::size_t begin() const { return begin_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0, begin_ = 0;
};

// Returns whether a word is one token that begins as a number does; whether it is one, the reader of values says.
bool is_like_a_number(std::string_view word) {
  constexpr std::array<std::string_view, 8> kNotFinite{"nan", "NaN", "NAN",      "inf",
                                                       "Inf", "INF", "infinity", "Infinity"};
  if (std::ranges::find(kNotFinite, word) != kNotFinite.end()) return true;
  Lexer lexer(word);
  const Token token = lexer.next();
  return token.kind == TokenKind::kNumber && token.text.size() == word.size();
}

// Returns how many numbers a single value has; nothing where any number will do.
std::optional<std::size_t> numbers_of(std::string_view type) {
  constexpr std::pair<std::string_view, std::size_t> kNumbers[] = {
      {"SFInt32", 1},    {"SFFloat", 1},     {"SFDouble", 1}, {"SFTime", 1},  {"SFVec2f", 2},
      {"SFVec2d", 2},    {"SFVec3f", 3},     {"SFVec3d", 3},  {"SFColor", 3}, {"SFVec4f", 4},
      {"SFRotation", 4}, {"SFColorRGBA", 4}, {"SFVec4d", 4}};
  for (const auto& [name, count] : kNumbers) {
    if (name == type) return count;
  }
  return std::nullopt;
}

void append_utf8(std::string& out, std::uint32_t c) {
  const auto tail = [&](int shift) { out += static_cast<char>(0x80U | ((c >> shift) & 0x3FU)); };
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0U | (c >> 6U));
    tail(0);
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0U | (c >> 12U));
    tail(6);
    tail(0);
  } else {
    out += static_cast<char>(0xF0U | (c >> 18U));
    tail(12);
    tail(6);
    tail(0);
  }
}

// Returns the character that stands between '&' and ';'.
std::optional<std::uint32_t> character_of(std::string_view entity) {
  constexpr std::pair<std::string_view, char> kNamed[] = {
      {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
  for (const auto& [name, character] : kNamed) {
    if (name == entity) return static_cast<std::uint32_t>(character);
  }
  if (!entity.starts_with('#')) return std::nullopt;
  entity.remove_prefix(1);
  const bool hexadecimal = entity.starts_with('x');
  if (hexadecimal) entity.remove_prefix(1);
  std::uint32_t c = 0;
  const auto [end, error] = std::from_chars(entity.data(), entity.data() + entity.size(), c, hexadecimal ? 16 : 10);
  const bool whole = !entity.empty() && error == std::errc{} && end == entity.data() + entity.size();
  const bool lawful = (c >= 0x20 || c == '\t' || c == '\n' || c == '\r') && c <= 0x10FFFF && (c < 0xD800 || c > 0xDFFF);
  return whole && lawful ? std::optional(c) : std::nullopt;
}

}  // namespace

void ClassicWriter::word(std::string_view word, std::size_t at) {
  made_.map.add_place(made_.text.size(), at);
  (made_.text += word) += ' ';
}

void ClassicWriter::name(std::string_view raw, std::size_t at) {
  const std::string decoded_name = raw.find('&') == std::string_view::npos ? std::string() : decoded(raw, at);
  const std::string_view name = decoded_name.empty() ? raw : decoded_name;
  Lexer lexer(name);
  const Token token = lexer.next();
  if (token.kind == TokenKind::kWord && token.text.size() == name.size()) return word(name, at);
  made_.map.add_place(made_.text.size(), at);
  ((made_.text += kNameMark) += name) += kNameMark;
  made_.text += ' ';
}

std::string ClassicWriter::decoded(std::string_view raw, std::size_t at) {
  constexpr std::size_t kLongestEntity = 16;
  std::string out;
  out.reserve(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw.substr(i, 2) == "\r\n") continue;  // one line end is one blank
    if (is_xml_blank(raw[i])) {
      out += ' ';
      continue;
    }
    if (raw[i] != '&') {
      out += raw[i];
      continue;
    }
    const std::size_t end = raw.substr(0, i + kLongestEntity).find(';', i);
    const std::string_view entity = raw.substr(i + 1, end == std::string_view::npos ? 0 : end - i - 1);
    if (const auto c = character_of(entity)) {
      append_utf8(out, *c);
      i = end;
    } else {
      fault(at + i,
            "no entity is known that begins " + quoted(raw.substr(i, kLongestEntity)) +
                ": those that a DTD declares are not read",
            "it stays as it is");
      out += '&';
    }
  }
  return out;
}

// Quotes and backslashes may be escaped already, as the Classic VRML encoding has them; a lone one is itself.
void ClassicWriter::string(std::string_view text) {
  made_.text += '"';
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\');
    if (escape) {
      made_.text += text.substr(i++, 2);
      continue;
    }
    if (text[i] == '"' || text[i] == '\\') made_.text += '\\';
    made_.text += text[i];
  }
  made_.text += "\" ";
}

void ClassicWriter::source(std::string_view text, std::size_t at) {
  made_.map.add_place(made_.text.size(), at);
  made_.text += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') made_.text += '\\';
    made_.text += c;
  }
  made_.text += "\" ";
}

void ClassicWriter::default_value(std::string_view type, std::size_t at) {
  made_.map.add_place(made_.text.size(), at);
  if (const auto known = find_field_type(type)) {
    (made_.text += default_text_of(*known)) += ' ';
  } else if (type.starts_with("MF")) {
    made_.text += "[ ] ";
  } else {
    for (std::size_t i = 0; i < numbers_of(type).value_or(1); ++i) made_.text += "0 ";
  }
}

bool ClassicWriter::value(std::string_view type, std::string_view field, std::string_view raw, std::size_t at) {
  if (type == "SFString") {
    const std::string text = decoded(raw, at);
    made_.map.add_place(made_.text.size(), at);
    string(text);
    return true;
  }
  if (type == "MFString") return strings(field, raw, at);
  if (type == "SFBool" || type == "MFBool") return flags(type, field, raw, at);
  if (type == "SFNode" || type == "MFNode") {
    const bool none = std::ranges::all_of(raw, is_xml_blank) || raw == "NULL";
    if (!none) fault(at, quoted(field) + " takes nodes, which stand between tags in XML", "the value is left out");
    if (none) default_value(type, at);
    return none;
  }
  return numbers(type, field, raw, at);
}

bool ClassicWriter::strings(std::string_view field, std::string_view raw, std::size_t at) {
  const std::string text = decoded(raw, at);
  Lexer lexer(text);
  bool good = true;
  std::vector<std::string_view> found;
  std::size_t end = 0;  // of the string before; the lexer takes what follows a '#' for a comment, which XML has not
  for (bool more = true; more && good;) {
    const Token token = lexer.next();
    more = token.kind != TokenKind::kEnd;
    const std::size_t begin = more ? token.offset : text.size();
    good = (token.kind == TokenKind::kString || !more) &&
           std::ranges::all_of(std::string_view(text).substr(end, begin - end), parts_values);
    if (more) found.push_back(token.text);
    end = begin + token.text.size() + 2;
  }
  if (!good) {
    fault(at, quoted(field) + " (MFString) wants strings in quotes, found " + vrml::quoted(text),
          "it is read as one string");
  }
  made_.map.add_place(made_.text.size(), at);
  made_.text += "[ ";
  if (good) {
    for (const std::string_view one : found) ((made_.text += '"') += one) += "\" ";
  } else {
    string(text);
  }
  made_.text += "] ";
  return true;
}

bool ClassicWriter::flags(std::string_view type, std::string_view field, std::string_view raw, std::size_t at) {
  std::string out;
  std::size_t count = 0;
  ValueWords words(raw);
  for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count) {
    if (word == "true" || word == "TRUE") {
      out += "TRUE ";
    } else if (word == "false" || word == "FALSE") {
      out += "FALSE ";
    } else {
      fault(at + words.begin(),
            quoted(field) + " (" + std::string(type) + ") wants true or false, found " + quoted(word),
            "the value is left out");
      return false;
    }
  }
  const bool list = type.starts_with("MF");
  if (!list && count != 1) {
    fault(at, quoted(field) + " (SFBool) wants true or false, found " + quoted(raw), "the value is left out");
    return false;
  }
  made_.map.add_place(made_.text.size(), at);
  made_.text += list ? "[ " + out + "] " : out;
  return true;
}

bool ClassicWriter::numbers(std::string_view type, std::string_view field, std::string_view raw, std::size_t at) {
  const bool encoded = raw.find('&') != std::string_view::npos;
  const std::string decoded_text = encoded ? decoded(raw, at) : std::string();
  const std::string_view text = encoded ? decoded_text : raw;
  if (encoded && text.find('&') != std::string_view::npos) return false;  // which is reported
  std::size_t count = 0;
  ValueWords words(text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count) {
    if (is_like_a_number(word)) continue;
    fault(encoded ? at : at + words.begin(),
          quoted(field) + " (" + std::string(type) + ") wants numbers, found " + quoted(word), "the value is left out");
    return false;
  }
  const auto wanted = numbers_of(type);
  if (wanted && count != *wanted) {
    fault(at,
          quoted(field) + " (" + std::string(type) + ") wants " +
              (*wanted == 1 ? "a number" : std::to_string(*wanted) + " numbers") + ", found " + std::to_string(count),
          "the value is left out");
    return false;
  }
  const bool list = type.starts_with("MF");
  made_.map.add_place(made_.text.size(), at);
  if (list) made_.text += "[ ";
  if (encoded) {
    made_.map.add_place(made_.text.size(), at);
  } else {
    made_.map.add_copy(made_.text.size(), at);
  }
  made_.text += text;
  made_.map.add_place(made_.text.size(), at + raw.size());
  made_.text += list ? " ] " : " ";
  return true;
}

}  // namespace peerd::vrml
