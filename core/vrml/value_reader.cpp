#include "core/vrml/value_reader.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/vrml/element_positions.hpp"
#include "core/vrml/field_checks.hpp"

namespace peerd::vrml {
namespace {

using enum TokenKind;

bool spells_non_finite(const Token& token) {
  constexpr std::string_view kSpellings[] = {"nan", "NaN", "NAN", "inf", "Inf", "INF", "infinity", "Infinity"};
  return token.kind == kWord && std::ranges::find(kSpellings, token.text) != std::end(kSpellings);
}

// The number that a lenient reading takes the beginning of a text for, which is no number of the field.
template <class T>
struct ForgivenNumber {
  T value{};
  std::size_t size_bytes = 0;  // how much of the text it stands for
  std::string_view text{};     // for people
};

template <class T>
std::expected<T, NumberError> number_in(std::string_view text) {
  if constexpr (std::is_same_v<T, std::int32_t>) {
    const auto whole = read_int32(text);
    if (whole) return whole;
    // 7.0 is 7, and 4294967295 has the bits of -1.
    const auto real = read_double(text);
    if (!real || !(*real > -2147483649.0 && *real < 4294967296.0)) return whole;
    return static_cast<std::int32_t>(static_cast<std::int64_t>(*real));
  } else if constexpr (std::is_same_v<T, float>) {
    return read_float(text);
  } else {
    return read_double(text);
  }
}

// 1-2-3 is 1 and what follows. A number that goes on otherwise (12abc) is the number it begins with; one that is too
// large, infinite or none is 0. The longest begin counts, and the search is short: numbers of more bytes are 0.
template <class T>
ForgivenNumber<T> forgiven_number(std::string_view text, NumberError error) {
  constexpr std::size_t kLongest = 64;
  if (const auto whole = number_in<T>(text)) return {*whole, text.size(), text};
  const std::size_t longest = error == NumberError::kSyntax ? std::min(text.size(), kLongest) : 1;
  for (std::size_t size = longest; size-- > 1;) {
    const auto value = number_in<T>(text.substr(0, size));
    if (!value) continue;
    const char next = text[size];
    return {*value, next == '-' || next == '+' || next == '.' ? size : text.size(), text.substr(0, size)};
  }
  return {T{}, text.size(), "0"};
}

bool is_rotation(FieldType type) { return type == FieldType::kSFRotation || type == FieldType::kMFRotation; }

}  // namespace

std::optional<Field> ValueReader::read(const FieldSpec& spec, bool check) {
  const bool bracketed = tokens_.lenient() && !is_list(spec.type) && tokens_.at(kOpenBracket);
  if (!bracketed) return read_unbracketed(spec, check);
  const Token open = tokens_.peek();
  tokens_.fault(tokens_.position(), quoted(spec.name) + " is one value, without brackets", "they are passed over");
  tokens_.take();
  const std::optional<Field> value = read_unbracketed(spec, check);
  while (!tokens_.at(kCloseBracket) && !tokens_.at(kCloseBrace) && !tokens_.at(kEnd)) {
    const Position before = tokens_.position();
    skip(true);
    if (tokens_.position() == before) break;
  }
  if (!tokens_.accept(kCloseBracket)) tokens_.report_unclosed(tokens_.position_of(open), "value", ']');
  return value;
}

std::optional<Field> ValueReader::read_unbracketed(const FieldSpec& spec, bool check) {
  using enum FieldType;
  std::optional<Field> value(Field{&spec, nullptr, 0, tokens_.position()});
  Field& field = *value;
  bool good = false;
  switch (spec.type) {
    case kSFBool:
      good = read_single<bool>(spec, field);
      break;
    case kSFInt32:
      good = read_single<std::int32_t>(spec, field);
      break;
    case kSFTime:
      good = read_single<double>(spec, field);
      break;
    case kSFString:
      good = read_single<std::string_view>(spec, field);
      break;
    case kMFTime:
      good = read_several<double>(spec, field);
      break;
    case kMFString:
      good = read_several<std::string_view>(spec, field);
      break;
    case kSFImage:
      good = read_image(spec, field);
      break;
    case kSFNode:
      good = read_one_node(spec, field);
      break;
    case kMFNode:
      good = read_nodes(spec, field);
      break;
    case kMFInt32:
      good = read_numbers<std::int32_t>(spec, field);
      break;
    default:
      good = read_floats(spec, field);
      if (good && is_rotation(spec.type)) check_axes(spec, field);
  }
  if (good && check) good = check_range(spec, field, problems_);
  if (!good) value.reset();
  return value;
}

// A word before a brace is the type of a node, which may have the name of a field: no value of a field begins with one.
bool ValueReader::at_next_field() {
  return tokens_.at(kWord) && is_field_ && is_field_(tokens_.peek().text) && tokens_.kind_after() != kOpenBrace;
}

bool ValueReader::list_ends(const Token& open, bool& good) {
  if (tokens_.at(kCloseBracket)) {
    tokens_.take();
  } else if (tokens_.at(kEnd)) {
    good = false;
    tokens_.report_unclosed(tokens_.position_of(open), "list", ']');
  } else if (tokens_.at(kCloseBrace) || at_next_field()) {
    good = false;
    tokens_.fault(tokens_.position(), "expected ']', found " + described(tokens_.peek()), "the list ends here");
  } else {
    return false;
  }
  --open_lists_;
  return true;
}

// Reads values in brackets, or one without. `read_one` takes one, or reports it and returns false.
template <class ReadOne>
bool ValueReader::read_list(ReadOne read_one) {
  const Token open = tokens_.peek();
  if (!tokens_.accept(kOpenBracket)) return read_one();
  ++open_lists_;
  bool good = true;
  while (!list_ends(open, good)) {
    const Position before = tokens_.position();
    if (read_one()) continue;
    good = false;
    if (tokens_.position() == before) skip(true);
  }
  return good || tokens_.lenient();
}

template <class T>
bool ValueReader::read_single(const FieldSpec& spec, Field& field) {
  T one{};
  if (!read_one(spec, one)) return false;
  keep<T>(field, {&one, 1});
  return true;
}

// Reads a list in brackets. Numbers of the plain kind are most of a world, and take a shorter way.
template <class T>
bool ValueReader::read_numbers(const FieldSpec& spec, Field& field) {
  if (!tokens_.at(kOpenBracket)) return read_single<T>(spec, field);
  const Token open = tokens_.peek();
  GrowingList<T> list(arena_, tokens_.count_numbers());
  tokens_.take();
  ++open_lists_;
  bool good = true;
  while (!list_ends(open, good)) {
    if (tokens_.at(kNumber)) {
      tokens_.take_numbers<T>([&](T value) { list.add(value); });
      if (!tokens_.at(kNumber)) continue;
    }
    T one{};
    const Position before = tokens_.position();
    if (read_one(spec, one)) {
      list.add(one);
      continue;
    }
    good = false;
    if (tokens_.position() == before) skip(true);
  }
  field.data = list.elements().data();
  field.count = static_cast<std::uint32_t>(list.elements().size());
  return good || tokens_.lenient();
}

template <class T>
bool ValueReader::read_several(const FieldSpec& spec, Field& field) {
  std::vector<T> list;
  const bool good = read_list([&] {
    T one{};
    if (!read_one(spec, one)) return false;
    list.push_back(one);
    return true;
  });
  if (!good) return false;
  keep<T>(field, list);
  return true;
}

bool ValueReader::expected_value(const FieldSpec& spec, std::string_view what) {
  if (tokens_.at(kEnd)) return false;  // the node that is never closed says it
  const bool bracketed = tokens_.at(kOpenBracket) && !is_list(spec.type);
  tokens_.fault(tokens_.position(),
                quoted(spec.name) + " (" + std::string(name_of(spec.type)) + ") wants " + std::string(what) +
                    ", found " + described(tokens_.peek()) + (bracketed ? ": it is one value, without brackets" : ""),
                open_lists_ > 0 ? "the element is left out" : "the field has its default value");
  if (bracketed) tokens_.skip_balanced();
  return false;
}

// Reports a number that is none, and gives what a lenient reading takes for it.
template <class T>
bool ValueReader::read_on_from(const FieldSpec& spec, NumberError error, T& value) {
  const Token token = tokens_.peek();
  const Position at = tokens_.position();
  const std::string type(name_of(spec.type));
  const std::string what = error == NumberError::kSyntax      ? " is not a number of " + type
                           : error == NumberError::kNotFinite ? " is not a finite number"
                                                              : " is too large for " + type;
  const ForgivenNumber<T> read = forgiven_number<T>(token.text, error);
  tokens_.fault(at, quoted(token.text) + what, "it is read as " + quoted(read.text));
  value = read.value;
  tokens_.lenient() ? tokens_.take_part(read.size_bytes) : static_cast<void>(tokens_.take());
  return tokens_.lenient();
}

template <class T>
bool ValueReader::take_number(const FieldSpec& spec, std::expected<T, NumberError> number, T& value) {
  if (!number) return read_on_from(spec, number.error(), value);
  tokens_.take();
  value = *number;
  return true;
}

bool ValueReader::read_one(const FieldSpec& spec, float& value) {
  if (tokens_.at(kNumber)) {
    const std::string_view text = tokens_.peek().text;
    const char* const begin = text.data();
    const char* const end = begin + text.size();
    if (scan_plain(begin, end, value) == end) return tokens_.take(), true;
    return take_number(spec, read_float(text), value);
  }
  if (!spells_non_finite(tokens_.peek())) return expected_value(spec, "a number");
  return take_number<float>(spec, std::unexpected(NumberError::kNotFinite), value);
}

bool ValueReader::read_one(const FieldSpec& spec, std::int32_t& value) {
  if (!tokens_.at(kNumber)) return expected_value(spec, "an integer");
  return take_number(spec, read_int32(tokens_.peek().text), value);
}

bool ValueReader::read_one(const FieldSpec& spec, double& value) {
  if (!tokens_.at(kNumber)) return expected_value(spec, "a time in seconds");
  return take_number(spec, read_double(tokens_.peek().text), value);
}

bool ValueReader::read_one(const FieldSpec& spec, bool& value) {
  if (tokens_.at_word("TRUE") || tokens_.at_word("FALSE")) {
    value = tokens_.take().text == "TRUE";
    return true;
  }
  constexpr std::string_view kTrue[] = {"true", "True", "1"}, kFalse[] = {"false", "False", "0"};
  const std::string_view found = tokens_.peek().text;
  const bool is_true = std::ranges::find(kTrue, found) != std::end(kTrue);
  if (!is_true && std::ranges::find(kFalse, found) == std::end(kFalse)) {
    expected_value(spec, "TRUE or FALSE");
    if (tokens_.at(kNumber) || tokens_.at(kString)) tokens_.take();
    return false;
  }
  tokens_.fault(tokens_.position(),
                quoted(spec.name) + " (" + std::string(name_of(spec.type)) + ") wants TRUE or FALSE, found " +
                    described(tokens_.peek()),
                is_true ? "it is read as TRUE" : "it is read as FALSE");
  tokens_.take();
  value = is_true;
  return tokens_.lenient();
}

bool ValueReader::read_one(const FieldSpec& spec, std::string_view& value) {
  if (!tokens_.at(kString)) return expected_value(spec, "a string in quotes");
  const std::string_view text = tokens_.take().text;
  value = arena_.copy(text.find('\\') == std::string_view::npos ? text : std::string_view(unescaped(text)));
  return true;
}

bool ValueReader::read_floats(const FieldSpec& spec, Field& field) {
  const auto width = static_cast<std::size_t>(float_count(spec.type));
  if (is_list(spec.type) && tokens_.at(kOpenBracket)) {
    if (!read_numbers<float>(spec, field)) return false;
    if (field.count % width == 0) return true;
    tokens_.fault(field.at,
                  quoted(spec.name) + " (" + std::string(name_of(spec.type)) + ") wants numbers by " +
                      std::to_string(width) + ", found " + std::to_string(field.count),
                  "the incomplete element at its end is left out");
    field.count -= static_cast<std::uint32_t>(field.count % width);
    return tokens_.lenient();
  }
  std::array<float, 4> floats{};
  bool good = true;
  std::size_t plain = 0;
  if (tokens_.at(kNumber)) {
    tokens_.take_numbers<float>([&](float value) { floats[plain++] = value; }, width);
  }
  for (std::size_t i = plain; i < width; ++i) {
    if (!tokens_.at(kNumber) && !spells_non_finite(tokens_.peek())) {
      return expected_value(spec, width == 1 ? "a number" : std::to_string(width) + " numbers");
    }
    if (!read_one(spec, floats[i])) good = false;
  }
  keep<float>(field, std::span<const float>(floats).first(width));
  return good;
}

// An axis of length 0 turns nothing, whatever the angle; the standard wants a unit vector, exporters write zeros.
void ValueReader::check_axes(const FieldSpec& spec, const Field& field) {
  const std::span<const float> f = field.as<float>();
  for (std::size_t i = 0; i < f.size(); i += 4) {
    if (f[i] != 0 || f[i + 1] != 0 || f[i + 2] != 0 || f[i + 3] == 0) continue;
    ElementPositions positions(problems_.text_of(field.at), problems_.begin_of(field.at), field.at);
    return tokens_.warning(
        positions.at(i), quoted(spec.name) + " has an axis of length 0 and an angle that is not 0; nothing is turned");
  }
}

bool ValueReader::read_image(const FieldSpec& spec, Field& field) {
  std::vector<std::int32_t> image(3, 0);
  for (std::int32_t& head : image) {
    if (!read_one(spec, head)) return false;
  }
  if (image[0] < 0 || image[1] < 0 || image[2] < 0 || image[2] > 4) {
    tokens_.fault(field.at,
                  quoted(spec.name) + " (SFImage) begins with its width and height, >= 0, and 0 to 4 components",
                  "the field has its default value");
    return false;
  }
  // The loop ends with the numbers of the text, however large the size claims to be.
  const std::int64_t pixels = std::int64_t{image[0]} * image[1];
  for (std::int64_t i = 0; i < pixels; ++i) {
    std::int32_t pixel = 0;
    if (!read_one(spec, pixel)) return false;
    image.push_back(pixel);
  }
  keep<std::int32_t>(field, image);
  return true;
}

bool ValueReader::read_one_node(const FieldSpec& spec, Field& field) {
  if (tokens_.at_word("NULL")) return tokens_.take(), true;
  if (!tokens_.at(kWord) || !read_node_) return expected_value(spec, "a node");
  const std::optional<NodeRef> ref = read_node_(spec);
  if (!ref) return false;
  keep<NodeRef>(field, {&*ref, 1});
  // An instance of an empty PROTO is no node, and no error.
  return ref->index != NodeRef::kNull || problems_.errors() == 0;
}

bool ValueReader::read_nodes(const FieldSpec& spec, Field& field) {
  if (tokens_.at_word("NULL")) return tokens_.take(), true;  // appendix C.5 of the thesis writes an empty list so
  const std::size_t first = refs_.size();
  const bool good = read_list([&] {
    if (!tokens_.at(kWord) || tokens_.at_word("NULL") || !read_node_) return expected_value(spec, "a node");
    // A node that cannot be read keeps its place among children as a null, so that child indices are those of the text.
    if (const std::optional<NodeRef> ref = read_node_(spec)) refs_.push_back(*ref);
    return true;
  });
  keep<NodeRef>(field, std::span<const NodeRef>(refs_).subspan(first));
  refs_.resize(first);
  return good;
}

std::vector<std::string_view> ValueReader::skip(bool in_list) {
  switch (tokens_.peek().kind) {
    case kNumber:
    case kString:
    case kPeriod:
      if (in_list) return tokens_.take(), std::vector<std::string_view>{};
      while (tokens_.at(kNumber) || tokens_.at(kString) || tokens_.at(kPeriod)) tokens_.take();
      return {};
    case kOpenBracket:
    case kOpenBrace:
      return tokens_.skip_balanced();
    case kWord:
      break;
    default:
      return {};
  }
  const bool node = tokens_.at_word("DEF") || tokens_.at_word("USE") ||
                    find_node_type(tokens_.peek().text) != nullptr || tokens_.kind_after() == kOpenBrace;
  if (node && read_node_) {
    constexpr FieldSpec kAnything{"", FieldType::kSFNode, Access::kField, {}, Range::kAny, kAnyClass};
    static_cast<void>(read_node_(kAnything));
  } else if (node || tokens_.at_word("TRUE") || tokens_.at_word("FALSE") || tokens_.at_word("NULL") || in_list) {
    tokens_.take();
  }
  return {};
}

}  // namespace peerd::vrml
