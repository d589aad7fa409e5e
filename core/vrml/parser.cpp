#include "core/vrml/parser.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

namespace peerd::vrml {
namespace {

using enum TokenKind;

std::string described(const Token& token) {
  switch (token.kind) {
    case kEnd:
      return "the end of the file";
    case kString:
    case kUnterminatedString:
      return "the string \"" + std::string(quoted(token.text)).substr(1);
    default:
      return quoted(token.text);
  }
}

bool spells_non_finite(std::string_view word) {
  constexpr std::string_view kSpellings[] = {"nan", "NaN", "NAN", "inf", "Inf", "INF", "infinity", "Infinity"};
  return std::ranges::find(kSpellings, word) != std::end(kSpellings);
}

bool in_range(double value, Range range) {
  switch (range) {
    case Range::kAny:
      return true;
    case Range::kNonNegative:
      return value >= 0.0;
    case Range::kPositive:
      return value > 0.0;
  }
  return false;
}

class Parser {
 public:
  Parser(std::string_view text, Spot begin, Problems& problems) : lexer_(text, begin), problems_(problems) { take(); }

  NodeTree parse_world();
  bool parse_value(const FieldSpec& spec, Value& value);

 private:
  Token take();
  bool accept(TokenKind kind);
  bool at_word(std::string_view word) const { return token_.kind == kWord && token_.text == word; }
  void error(const Spot& spot, std::string message);

  bool parse_statement();
  void parse_proto(bool external);
  void parse_route();
  NodeRef parse_node();
  NodeRef parse_use();
  NodeRef parse_body(const Token& def, const Token& type_name, const Spot& begin);
  void parse_fields(Node& node);
  void parse_field(Node& node);
  void parse_unknown_field(Node& node, const Token& name);
  void report_unknown_type(const Token& name);
  bool check_place(const FieldSpec& spec, const NodeRef& ref);

  template <class T, class ParseOne>
  bool parse_list(std::vector<T>& out, ParseOne parse_one);
  bool parse_float(const FieldSpec& spec, float& value);
  bool parse_floats(const FieldSpec& spec, Value& value);
  bool check_axes(const FieldSpec& spec, std::span<const float> floats, std::span<const Spot> axes);
  bool parse_int(const FieldSpec& spec, std::int32_t& value);
  bool parse_time(const FieldSpec& spec, double& value);
  bool parse_bool(const FieldSpec& spec, bool& value);
  bool parse_string(const FieldSpec& spec, std::string& value);
  bool parse_image(const FieldSpec& spec, std::vector<std::int32_t>& value);
  bool parse_node_value(const FieldSpec& spec, NodeRef& value);
  bool expected_value(const FieldSpec& spec, std::string_view what);
  template <class T>
  bool take_number(const FieldSpec& spec, std::expected<T, NumberError> number, T& value);

  void skip_value(bool in_list = false);
  void skip_balanced();
  void lose(const Token& name) {
    if (!name.text.empty()) tree_.defined[name.text] = {name.spot.offset, NodeRef::kNull, false};
  }
  bool ends_list() const;

  Lexer lexer_;
  Token token_;  // the next one to take
  Problems& problems_;
  NodeTree tree_;
  std::vector<std::string_view> protos_;
  const NodeType* type_ = nullptr;  // of the innermost open node
  std::uint32_t nesting_ = 0;
  std::uint32_t open_lists_ = 0;
  bool unclosed_reported_ = false;
};

Token Parser::take() {
  const Token taken = token_;
  token_ = lexer_.next();
  while (token_.kind == kInvalid || token_.kind == kUnterminatedString) {
    const bool string = token_.kind == kUnterminatedString;
    error(token_.spot, string ? "this string is never closed: a '\"' is missing"
                              : quoted(token_.text) + " cannot stand here: no VRML token contains it");
    token_ = lexer_.next();
  }
  return taken;
}

bool Parser::accept(TokenKind kind) {
  if (token_.kind != kind) return false;
  take();
  return true;
}

void Parser::error(const Spot& spot, std::string message) {
  problems_.error(spot, std::move(message));
  if (problems_.full()) lexer_.stop();
}

NodeTree Parser::parse_world() {
  while (token_.kind != kEnd) {
    if (token_.kind == kWord) {
      const Spot spot = token_.spot;
      if (parse_statement()) continue;
      const NodeRef ref = parse_node();
      if (ref && tree_.nodes[ref.index].type->node_class != kChild) {
        problems_.warning(spot, std::string(tree_.nodes[ref.index].type->name) +
                                    " at the top level is not part of the scene by itself");
      }
      tree_.top_level.push_back(ref);
      continue;
    }
    error(token_.spot, "expected a node, found " + described(token_));
    while (token_.kind != kEnd && token_.kind != kWord) take();
  }
  return std::move(tree_);
}

// PROTO, EXTERNPROTO and ROUTE: reported, and passed over so that the rest can be checked.
bool Parser::parse_statement() {
  if (at_word("PROTO")) return parse_proto(false), true;
  if (at_word("EXTERNPROTO")) return parse_proto(true), true;
  if (at_word("ROUTE")) return parse_route(), true;
  return false;
}

void Parser::parse_proto(bool external) {
  const Token keyword = take();
  const std::string_view name = token_.kind == kWord ? take().text : std::string_view{};
  error(keyword.spot, std::string(keyword.text) + " is not read yet: " + quoted(name));
  if (!name.empty()) protos_.push_back(name);
  if (token_.kind == kOpenBracket) skip_balanced();
  if (external) {
    token_.kind == kOpenBracket ? skip_balanced() : static_cast<void>(accept(kString));
  } else if (token_.kind == kOpenBrace) {
    skip_balanced();
  }
}

void Parser::parse_route() {
  const Token keyword = take();
  const auto end = [&] {
    std::string name;
    if (token_.kind == kWord) name = take().text;
    if (accept(kPeriod)) name += '.';
    if (name.ends_with('.') && token_.kind == kWord) name += take().text;
    return name;
  };
  std::string route = end();
  if (at_word("TO")) {
    take();
    route += " TO " + end();
  }
  error(keyword.spot, "ROUTE is not read yet: " + quoted(route));
}

NodeRef Parser::parse_node() {
  if (at_word("USE")) return parse_use();
  const Spot begin = token_.spot;
  Token def;
  if (at_word("DEF")) {
    take();
    if (token_.kind != kWord || is_keyword(token_.text)) {
      error(token_.spot, "expected a name after DEF, found " + described(token_));
      if (token_.kind != kWord && token_.kind != kNumber) return {};
      take();
    } else {
      def = take();
    }
  }
  if (token_.kind != kWord) {
    error(token_.spot, "expected a node type, found " + described(token_));
    lose(def);
    return {};
  }
  const Token type_name = take();
  return parse_body(def, type_name, begin);
}

NodeRef Parser::parse_use() {
  const Token use = take();
  if (token_.kind != kWord || is_keyword(token_.text)) {
    error(token_.spot, "expected a DEF name after USE, found " + described(token_));
    return {};
  }
  const Token name = take();
  const auto it = tree_.defined.find(name.text);
  if (it == tree_.defined.end()) {
    Suggestion suggestion(name.text);
    constexpr std::size_t kFewEnough = 4096;  // a misspelt name among millions must not cost minutes
    if (tree_.defined.size() <= kFewEnough) {
      std::vector<std::pair<std::size_t, std::string_view>> names;  // in text order: a hash map has none to rely on
      for (const auto& [known, definition] : tree_.defined) names.emplace_back(definition.offset, known);
      std::ranges::sort(names);
      for (const auto& entry : names) suggestion.consider(entry.second);
    }
    error(name.spot, "USE of " + quoted(name.text) + ", which no DEF before it names" + did_you_mean(suggestion));
    return {};
  }
  if (it->second.open) {
    error(name.spot, "USE of " + quoted(name.text) + " inside that node itself: a node cannot contain itself");
    return {};
  }
  return {it->second.index, use.spot};
}

void Parser::report_unknown_type(const Token& name) {
  if (std::ranges::find(protos_, name.text) != protos_.end()) {
    return error(name.spot, quoted(name.text) + " is an instance of a PROTO, which is not read yet");
  }
  if (std::ranges::find(nodes_not_read_yet(), name.text) != nodes_not_read_yet().end()) {
    return error(name.spot, std::string(name.text) + " is not read yet");
  }
  Suggestion suggestion(name.text);
  for (const NodeType& type : node_types()) suggestion.consider(type.name);
  for (const std::string_view other : nodes_not_read_yet()) suggestion.consider(other);
  const bool node = token_.kind == kOpenBrace;
  error(name.spot, (node ? "unknown node type " : "expected a node, found ") + quoted(name.text) + did_you_mean(suggestion));
}

NodeRef Parser::parse_body(const Token& def, const Token& type_name, const Spot& begin) {
  const NodeType* type = find_node_type(type_name.text);
  if (type == nullptr) report_unknown_type(type_name);
  if (type != nullptr && token_.kind != kOpenBrace) {
    error(token_.spot, "expected '{' after " + std::string(type->name) + ", found " + described(token_));
  } else if (type != nullptr && nesting_ >= kMaxNesting) {
    error(type_name.spot, "nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    type = nullptr;
  }
  if (type == nullptr || token_.kind != kOpenBrace) {
    lose(def);
    if (token_.kind == kOpenBrace) {
      skip_balanced();
    } else if (nesting_ == 0) {
      while (token_.kind != kEnd &&
             !(token_.kind == kWord && (is_keyword(token_.text) || find_node_type(token_.text)))) {
        take();
      }
    }
    return {};
  }

  Node node;
  node.type = type;
  node.def = def.text;
  node.spot = begin;
  if (!def.text.empty()) tree_.defined[def.text] = {def.spot.offset, NodeRef::kNull, true};
  const NodeType* outer = std::exchange(type_, type);
  ++nesting_;
  parse_fields(node);
  --nesting_;
  type_ = outer;

  const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
  if (!def.text.empty()) {
    // A node inside this one may have taken the name over.
    Definition& definition = tree_.defined[def.text];
    if (definition.offset == def.spot.offset) definition = {def.spot.offset, index, false};
  }
  tree_.nodes.push_back(std::move(node));
  return {index, begin};
}

void Parser::parse_fields(Node& node) {
  const Token open = take();
  const std::string type(node.type->name);
  while (true) {
    switch (token_.kind) {
      case kCloseBrace:
        take();
        return;
      case kWord:
        if (!parse_statement()) parse_field(node);
        break;
      case kEnd:
        node.damaged = true;
        if (!std::exchange(unclosed_reported_, true)) {
          error(open.spot, "this " + type + " is never closed: a '}' is missing");
        }
        return;
      case kCloseBracket:
        node.damaged = true;
        error(token_.spot, "expected a field of " + type + " or its '}', found ']'");
        if (open_lists_ > 0) return;
        take();
        break;
      default:
        node.damaged = true;
        error(token_.spot, "expected a field of " + type + ", found " + described(token_));
        while (token_.kind == kNumber || token_.kind == kString || token_.kind == kPeriod) take();
        if (token_.kind == kOpenBrace || token_.kind == kOpenBracket) skip_balanced();
    }
  }
}

void Parser::parse_field(Node& node) {
  const Token name = take();
  const FieldSpec* spec = find_field(*node.type, name.text);
  if (spec == nullptr) return parse_unknown_field(node, name);
  if (at_word("IS")) {
    node.damaged = true;
    error(token_.spot, "IS belongs inside a PROTO");
    take();
    if (token_.kind == kWord) take();
    return;
  }
  if (spec->access == Access::kEventIn || spec->access == Access::kEventOut) {
    node.damaged = true;
    error(name.spot, quoted(name.text) + " is an " + (spec->access == Access::kEventIn ? "eventIn" : "eventOut") +
                         " of " + std::string(node.type->name) + ": a file cannot give it a value");
    return skip_value();
  }
  if (node.find(name.text) != nullptr) {
    problems_.warning(name.spot, quoted(name.text) + " is given twice; the last one counts");
    std::erase_if(node.fields, [&](const FieldValue& f) { return f.spec == spec; });
  }
  FieldValue field{spec, token_.spot, {}};
  if (parse_value(*spec, field.value)) {
    node.fields.push_back(std::move(field));
  } else {
    node.damaged = true;
  }
}

void Parser::parse_unknown_field(Node& node, const Token& name) {
  node.damaged = true;
  const std::string type(node.type->name);
  if (token_.kind == kOpenBrace && find_node_type(name.text) != nullptr) {
    error(name.spot, quoted(name.text) + " is a node; the name of a field of " + type + " is missing before it");
    parse_body({}, name, name.spot);
    return;
  }
  Suggestion suggestion(name.text);
  for (const FieldSpec& field : node.type->fields) suggestion.consider(field.name);
  error(name.spot, type + " has no field " + quoted(name.text) + did_you_mean(suggestion));
  skip_value();
}

bool Parser::check_place(const FieldSpec& spec, const NodeRef& ref) {
  const NodeType& type = *tree_.nodes[ref.index].type;
  if ((spec.accepts & type.node_class) != 0) return true;
  std::string message = quoted(spec.name) + " takes " + std::string(name_of(static_cast<NodeClass>(spec.accepts))) +
                        "; " + std::string(type.name) + " is " + std::string(name_of(type.node_class));
  if (spec.accepts == kChild && type.node_class == kGeometry) {
    message += ": write Shape { geometry " + std::string(type.name) + " { .. } }";
  }
  error(ref.spot, message);
  return false;
}

// Whether a word among the values of a list shows that the list's ']' was forgotten: the next field of the node.
bool Parser::ends_list() const { return type_ != nullptr && find_field(*type_, token_.text) != nullptr; }

template <class T, class ParseOne>
bool Parser::parse_list(std::vector<T>& out, ParseOne parse_one) {
  const Token open = token_;
  if (!accept(kOpenBracket)) {
    T one{};
    if (!parse_one(one)) return false;
    out.push_back(std::move(one));
    return true;
  }
  ++open_lists_;
  bool good = true;
  while (token_.kind != kCloseBracket) {
    const bool ended = token_.kind == kEnd || token_.kind == kCloseBrace || (token_.kind == kWord && ends_list());
    if (ended) {
      if (token_.kind != kEnd) {
        error(token_.spot, "expected ']', found " + described(token_));
      } else if (!std::exchange(unclosed_reported_, true)) {
        error(open.spot, "this list is never closed: a ']' is missing");
      }
      --open_lists_;
      return false;
    }
    T one{};
    const std::size_t before = token_.spot.offset;
    if (parse_one(one)) {
      out.push_back(std::move(one));
    } else {
      good = false;
      if (token_.spot.offset == before) skip_value(true);
    }
  }
  take();
  --open_lists_;
  return good;
}

bool Parser::expected_value(const FieldSpec& spec, std::string_view what) {
  if (token_.kind == kEnd) return false;  // the node that is never closed says it
  const bool bracketed = token_.kind == kOpenBracket && !is_list(spec.type);
  error(token_.spot, quoted(spec.name) + " (" + std::string(name_of(spec.type)) + ") wants " + std::string(what) +
                         ", found " + described(token_) + (bracketed ? ": it is one value, without brackets" : ""));
  if (bracketed) skip_balanced();
  return false;
}

template <class T>
bool Parser::take_number(const FieldSpec& spec, std::expected<T, NumberError> number, T& value) {
  if (!number) {
    switch (number.error()) {
      case NumberError::kSyntax:
        error(token_.spot, quoted(token_.text) + " is not a number of " + std::string(name_of(spec.type)));
        break;
      case NumberError::kNotFinite:
        error(token_.spot, quoted(token_.text) + " is not a finite number");
        break;
      case NumberError::kOverflow:
        error(token_.spot, quoted(token_.text) + " is too large for " + std::string(name_of(spec.type)));
        break;
    }
    take();
    return false;
  }
  if (!in_range(static_cast<double>(*number), spec.range)) {
    error(token_.spot, quoted(spec.name) + (spec.range == Range::kPositive ? " must be > 0" : " must be >= 0") +
                           ", found " + described(token_));
    take();
    return false;
  }
  value = *number;
  take();
  return true;
}

bool Parser::parse_float(const FieldSpec& spec, float& value) {
  if (token_.kind == kNumber) return take_number(spec, read_float(token_.text), value);
  if (token_.kind != kWord || !spells_non_finite(token_.text)) return expected_value(spec, "a number");
  return take_number<float>(spec, std::unexpected(NumberError::kNotFinite), value);
}

bool Parser::parse_floats(const FieldSpec& spec, Value& value) {
  const auto width = static_cast<std::size_t>(float_count(spec.type));
  const bool rotation = spec.type == FieldType::kSFRotation || spec.type == FieldType::kMFRotation;
  const bool bracketed = token_.kind == kOpenBracket;
  const Spot begin = token_.spot;
  std::vector<float> floats;
  std::vector<Spot> axes;
  bool good = true;
  if (is_list(spec.type) && bracketed) {
    good = parse_list(floats, [&](float& f) {
      if (rotation && floats.size() % width == 0) axes.push_back(token_.spot);
      return parse_float(spec, f);
    });
    if (good && floats.size() % width != 0) {
      error(begin, quoted(spec.name) + " (" + std::string(name_of(spec.type)) + ") wants numbers by " +
                       std::to_string(width) + ", found " + std::to_string(floats.size()));
      good = false;
    }
  } else {
    Floats one{};
    for (std::size_t i = 0; i < width; ++i) {
      if (token_.kind != kNumber && !(token_.kind == kWord && spells_non_finite(token_.text))) {
        return expected_value(spec, width == 1 ? "a number" : std::to_string(width) + " numbers");
      }
      if (!parse_float(spec, one[i])) good = false;
    }
    if (rotation && good) good = check_axes(spec, one, {&begin, 1});
    if (is_list(spec.type)) {
      floats.assign(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(width));
    } else {
      value = one;
    }
  }
  if (rotation && good) good = check_axes(spec, floats, axes);
  if (is_list(spec.type)) value = std::move(floats);
  return good;
}

// An axis of length 0 turns nothing and so must come with an angle of 0.
bool Parser::check_axes(const FieldSpec& spec, std::span<const float> floats, std::span<const Spot> axes) {
  bool good = true;
  for (std::size_t i = 0; i / 4 < axes.size(); i += 4) {
    if (floats[i] != 0 || floats[i + 1] != 0 || floats[i + 2] != 0 || floats[i + 3] == 0) continue;
    error(axes[i / 4], quoted(spec.name) + " has an axis of length 0 and an angle that is not 0");
    good = false;
  }
  return good;
}

bool Parser::parse_int(const FieldSpec& spec, std::int32_t& value) {
  if (token_.kind != kNumber) return expected_value(spec, "an integer");
  return take_number(spec, read_int32(token_.text), value);
}

bool Parser::parse_time(const FieldSpec& spec, double& value) {
  if (token_.kind != kNumber) return expected_value(spec, "a time in seconds");
  return take_number(spec, read_double(token_.text), value);
}

bool Parser::parse_bool(const FieldSpec& spec, bool& value) {
  if (!at_word("TRUE") && !at_word("FALSE")) {
    expected_value(spec, "TRUE or FALSE");
    constexpr std::string_view kMeant[] = {"true", "false", "True", "False"};
    const bool meant = std::ranges::find(kMeant, token_.text) != std::end(kMeant);
    if (meant || token_.kind == kNumber || token_.kind == kString) take();
    return false;
  }
  value = take().text == "TRUE";
  return true;
}

bool Parser::parse_string(const FieldSpec& spec, std::string& value) {
  if (token_.kind != kString) return expected_value(spec, "a string in quotes");
  value = unescaped(take().text);
  return true;
}

bool Parser::parse_image(const FieldSpec& spec, std::vector<std::int32_t>& value) {
  value.assign(3, 0);
  for (std::int32_t& head : value) {
    if (!parse_int(spec, head)) return false;
  }
  if (value[0] < 0 || value[1] < 0 || value[2] < 0 || value[2] > 4) {
    error(token_.spot,
          quoted(spec.name) + " (SFImage) wants width, height >= 0 and 0 to 4 components before this place");
    return false;
  }
  // The loop ends with the text's numbers, however large the size claims to be.
  const std::int64_t pixels = std::int64_t{value[0]} * value[1];
  for (std::int64_t i = 0; i < pixels; ++i) {
    std::int32_t pixel = 0;
    if (!parse_int(spec, pixel)) return false;
    value.push_back(pixel);
  }
  return true;
}

bool Parser::parse_node_value(const FieldSpec& spec, NodeRef& value) {
  if (token_.kind != kWord) return expected_value(spec, "a node");
  if (at_word("NULL") && !is_list(spec.type)) {
    take();
    return true;
  }
  // What cannot be read keeps its place among children as a null, so that child indices stay the text's.
  if (parse_statement()) return is_list(spec.type);
  value = parse_node();
  if (value && !check_place(spec, value)) value = {};
  return value || is_list(spec.type);
}

bool Parser::parse_value(const FieldSpec& spec, Value& value) {
  using enum FieldType;
  switch (spec.type) {
    case kSFBool:
      return parse_bool(spec, value.emplace<bool>());
    case kSFInt32:
      return parse_int(spec, value.emplace<std::int32_t>());
    case kSFTime:
      return parse_time(spec, value.emplace<double>());
    case kSFString:
      return parse_string(spec, value.emplace<std::string>());
    case kSFImage:
      return parse_image(spec, value.emplace<std::vector<std::int32_t>>());
    case kSFNode:
      return parse_node_value(spec, value.emplace<NodeRef>());
    case kMFInt32:
      return parse_list(value.emplace<std::vector<std::int32_t>>(), [&](auto& one) { return parse_int(spec, one); });
    case kMFTime:
      return parse_list(value.emplace<std::vector<double>>(), [&](auto& one) { return parse_time(spec, one); });
    case kMFString:
      return parse_list(value.emplace<std::vector<std::string>>(), [&](auto& one) { return parse_string(spec, one); });
    case kMFNode:
      value.emplace<std::vector<NodeRef>>();
      if (at_word("NULL")) return take(), true;  // the seed's appendix C.5 writes an empty list so
      return parse_list(value.emplace<std::vector<NodeRef>>(), [&](auto& one) { return parse_node_value(spec, one); });
    default:
      return parse_floats(spec, value);
  }
}

// Passes over a value whose type is not known. Nodes in it are read, for what is wrong in them and for their names.
void Parser::skip_value(bool in_list) {
  switch (token_.kind) {
    case kNumber:
    case kString:
    case kPeriod:
      while (token_.kind == kNumber || token_.kind == kString || token_.kind == kPeriod) take();
      return;
    case kOpenBracket:
    case kOpenBrace:
      return skip_balanced();
    case kWord:
      break;
    default:
      return;
  }
  Lexer ahead = lexer_;
  if (at_word("DEF") || at_word("USE") || (token_.kind == kWord && find_node_type(token_.text) != nullptr) ||
      ahead.next().kind == kOpenBrace) {
    parse_node();
  } else if (at_word("TRUE") || at_word("FALSE") || at_word("NULL") || in_list) {
    take();
  }
}

// From '{' or '[' to its partner, whatever is between. Names defined in there are known to be lost.
void Parser::skip_balanced() {
  assert(token_.kind == kOpenBrace || token_.kind == kOpenBracket);
  const Token open = token_;
  std::size_t depth = 0;
  do {
    if (token_.kind == kEnd) {
      if (!std::exchange(unclosed_reported_, true)) error(open.spot, "this " + described(open) + " is never closed");
      return;
    }
    if (token_.kind == kOpenBrace || token_.kind == kOpenBracket) ++depth;
    if (token_.kind == kCloseBrace || token_.kind == kCloseBracket) --depth;
    const bool def = take().text == "DEF";
    if (def && token_.kind == kWord) lose(token_);
  } while (depth > 0);
}

}  // namespace

NodeTree parse(std::string_view text, Spot begin, Problems& problems) {
  return Parser(text, begin, problems).parse_world();
}

ElementSpots::ElementSpots(std::string_view text, const FieldValue& list)
    : lexer_(text, list.spot), token_(lexer_.next()) {
  if (token_.kind == kOpenBracket) token_ = lexer_.next();
}

Spot ElementSpots::at(std::size_t element) {
  assert(element >= element_);
  for (; element_ < element; ++element_) token_ = lexer_.next();
  return token_.spot;
}

std::optional<Value> default_value(const FieldSpec& spec) {
  if (spec.access == Access::kEventIn || spec.access == Access::kEventOut) return std::nullopt;
  Problems problems;
  FieldSpec unchecked = spec;
  unchecked.range = Range::kAny;
  Value value;
  const bool good = Parser(spec.default_value, {}, problems).parse_value(unchecked, value);
  assert(good && "a default in the table does not parse");
  return good ? std::optional(std::move(value)) : std::nullopt;
}

}  // namespace peerd::vrml
