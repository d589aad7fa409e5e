// TextParser: PROTO, EXTERNPROTO and which type a name means.
#include <algorithm>
#include <unordered_set>
#include <utility>

#include "core/vrml/field_checks.hpp"
#include "core/vrml/text_parser.hpp"

namespace peerd::vrml {

using enum TokenKind;

namespace {

// What an interface declares, as it is read.
struct Interface {
  std::vector<FieldSpec> specs{};
  std::vector<std::optional<Field>> defaults{};
  std::unordered_set<std::string_view> names{};

  [[nodiscard]] bool has(std::string_view name) const { return names.contains(name); }
  // 4.7: an exposedField x is also set_x and x_changed.
  [[nodiscard]] bool conflicts(std::string_view name, Access access) const {
    if (has(name)) return true;
    if (access == Access::kExposedField) return has("set_" + std::string(name)) || has(std::string(name) + "_changed");
    const auto exposed = [&](std::string_view base) {
      const auto it = std::ranges::find(specs, base, &FieldSpec::name);
      return it != specs.end() && it->access == Access::kExposedField;
    };
    return (name.starts_with("set_") && exposed(name.substr(4))) ||
           (name.ends_with("_changed") && exposed(name.substr(0, name.size() - 8)));
  }
  void add(const FieldSpec& spec, const std::optional<Field>& value) {
    names.insert(spec.name);
    specs.push_back(spec);
    defaults.push_back(value);
  }
};

void keep(Interface& interface, Prototype& prototype, Arena& arena) {
  const auto kept = arena.copy(std::span<const FieldSpec>(interface.specs));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (interface.defaults[i]) interface.defaults[i]->spec = &kept[i];
  }
  prototype.type.fields = kept;
  prototype.defaults = std::move(interface.defaults);
}

}  // namespace

void TextParser::check_name(const Token& name) {
  const bool own = std::ranges::find(kExtensionNodes, name.text) != std::end(kExtensionNodes);
  if (find_node_type(name.text) != nullptr && !own) {
    tokens_.error(tokens_.position_of(name),
                  quoted(name.text) + " is a node of the standard: no PROTO can take its name");
  } else if (scope_->declarations.contains(name.text)) {
    tokens_.warning(tokens_.position_of(name),
                    "a PROTO " + quoted(name.text) + " is there already; this one counts from here on");
  }
}

// One without a name.
void TextParser::skip_declaration(const std::string& keyword) {
  tokens_.error(tokens_.position(), "expected a name after " + keyword + ", found " + described(tokens_.peek()));
  if (tokens_.at(kWord)) tokens_.take();
  if (tokens_.at(kOpenBracket)) skip_balanced();
  if (tokens_.at(kOpenBracket) || tokens_.at(kOpenBrace)) return skip_balanced();
  if (tokens_.at(kString)) tokens_.take();
}

// To the next declaration of an interface, or to its end.
void TextParser::skip_to_declaration() {
  while (!tokens_.at(kEnd) && !tokens_.at(kCloseBracket) && !tokens_.at(kCloseBrace)) {
    if (tokens_.at(kWord) && find_access(tokens_.peek().text)) return;
    if (tokens_.at(kOpenBracket) || tokens_.at(kOpenBrace)) {
      skip_balanced();
    } else {
      tokens_.take();
    }
  }
}

void TextParser::parse_proto() {
  const Token keyword = tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return skip_declaration("PROTO");
  const Token name = tokens_.take();
  check_name(name);
  Prototype& prototype = context_.prototypes.emplace_back();
  prototype.type = {arena_.copy(name.text), kAnyClass, NodeRole::kPart, {}};
  if (nesting_ >= kMaxNesting) {
    tokens_.error(tokens_.position_of(keyword),
                  "PROTOs and nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    if (tokens_.at(kOpenBracket)) skip_balanced();
    if (tokens_.at(kOpenBrace)) skip_balanced();
    return;
  }
  ++nesting_;
  OpenNode* const outer_open = std::exchange(open_, nullptr);
  parse_interface(name.text, true, prototype);
  parse_body_of(prototype, name.text);
  open_ = outer_open;
  --nesting_;
  Declaration declaration{.prototype = &prototype, .interface = prototype.type.fields, .at = tokens_.position_of(name)};
  add_native(declaration, name.text);
  scope_->declarations[prototype.type.name] = declaration;
}

// FIELDTYPE NAME, or an error.
std::optional<std::pair<FieldType, Token>> TextParser::parse_type_and_name() {
  const auto type = tokens_.at(kWord) ? find_field_type(tokens_.peek().text) : std::nullopt;
  if (!type) {
    Suggestion suggestion(tokens_.peek().text);
    for (int t = 0; t <= static_cast<int>(FieldType::kMFVec3f); ++t)
      suggestion.consider(name_of(static_cast<FieldType>(t)));
    tokens_.error(tokens_.position(),
                  "expected a field type, found " + described(tokens_.peek()) + did_you_mean(suggestion));
    return std::nullopt;
  }
  tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
    tokens_.error(tokens_.position(), "expected the name of a field, found " + described(tokens_.peek()));
    return std::nullopt;
  }
  return std::pair(*type, tokens_.take());
}

// Its nodes stand in the prototype's body, and are in none of its names (4.4.3).
std::optional<Field> TextParser::parse_default(const FieldSpec& spec, Prototype& prototype) {
  Scope scope{.outer = scope_, .body = &prototype.body};
  Scope* const outer = std::exchange(scope_, &scope);
  const std::optional<Field> value = values_.read(spec);
  close(scope);
  scope_ = outer;
  return value;
}

// The declarations between '[' and ']', with default values for a PROTO. Those that can be read are kept.
bool TextParser::parse_interface(std::string_view name, bool with_values, Prototype& prototype) {
  if (!tokens_.at(kOpenBracket)) {
    tokens_.error(tokens_.position(),
                  "expected '[' and the interface of " + quoted(name) + ", found " + described(tokens_.peek()));
    return false;
  }
  const Token bracket = tokens_.take();
  Interface interface;
  bool good = true;
  while (!tokens_.at(kCloseBracket)) {
    if (tokens_.at(kEnd)) {
      good = false;
      tokens_.report_unclosed(tokens_.position_of(bracket), "interface", ']');
      break;
    }
    const auto access = tokens_.at(kWord) ? find_access(tokens_.peek().text) : std::nullopt;
    if (!access) {
      good = false;
      tokens_.error(tokens_.position(), "expected eventIn, eventOut, field, exposedField or ']' in the interface of " +
                                            quoted(name) + ", found " + described(tokens_.peek()));
      if (tokens_.at(kCloseBrace) || tokens_.at(kOpenBrace)) break;  // the ']' is missing
      skip_to_declaration();
      continue;
    }
    tokens_.take();
    const auto type_and_name = parse_type_and_name();
    if (!type_and_name) {
      good = false;
      skip_to_declaration();
      continue;
    }
    const auto& [type, field] = *type_and_name;
    if (interface.conflicts(field.text, *access)) {
      good = false;
      tokens_.error(tokens_.position_of(field),
                    quoted(field.text) + " is in the interface of " + quoted(name) + " already");
    }
    const FieldSpec spec{arena_.copy(field.text), type, *access, {}, Range::kAny, kAnyClass};
    std::optional<Field> value;
    if (with_values && has_value(*access)) {
      value = parse_default(spec, prototype);
      good = good && value.has_value();
      if (!value) skip_to_declaration();
    }
    if (interface.has(field.text)) continue;
    if (interface.specs.size() == kMaxFields) too_many(tokens_.position_of(field));
    if (interface.specs.size() < kMaxFields) interface.add(spec, value);
  }
  tokens_.accept(kCloseBracket);
  keep(interface, prototype, arena_);
  return good;
}

void TextParser::parse_body_of(Prototype& prototype, std::string_view name) {
  if (!tokens_.at(kOpenBrace)) {
    return tokens_.error(tokens_.position(),
                         "expected '{' and the body of " + quoted(name) + ", found " + described(tokens_.peek()));
  }
  const Token brace = tokens_.take();
  Scope scope{.outer = scope_, .body = &prototype.body, .prototype = &prototype};
  scope_ = &scope;
  Body& body = prototype.body;
  while (!tokens_.at(kCloseBrace)) {
    if (tokens_.at(kEnd)) {
      tokens_.report_unclosed(tokens_.position_of(brace), "PROTO", '}');
      break;
    }
    if (tokens_.at(kWord)) {
      if (!parse_statement()) body.roots.push_back(parse_node());
      continue;
    }
    tokens_.error(tokens_.position(),
                  "expected a node or the '}' of " + quoted(name) + ", found " + described(tokens_.peek()));
    if (tokens_.at(kOpenBrace) || tokens_.at(kOpenBracket)) {
      skip_balanced();
    } else {
      tokens_.take();
    }
  }
  tokens_.accept(kCloseBrace);
  close(scope);
  scope_ = scope.outer;
  if (body.roots.empty()) {
    tokens_.warning(
        tokens_.position_of(brace),
        "the body of " + quoted(name) + " has no node, so its instances are none either; the standard wants one");
  } else if (body.roots.front().is_node()) {
    const NodeType& first = *body.nodes[body.roots.front().index].type;
    prototype.type.classes = first.classes;
  }
  for (const IsLink& link : prototype.links) {
    if (!has_value(link.outer->access) || !has_value(link.inner->access)) continue;
    const auto& value = prototype.defaults[static_cast<std::size_t>(link.outer - prototype.type.fields.data())];
    if (!value) continue;  // it could not be read
    check_nodes(*link.inner, *value, body.nodes, problems_);
    check_range(*link.inner, *value, problems_);
  }
  sort_links(prototype);
}

void TextParser::parse_externproto() {
  tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return skip_declaration("EXTERNPROTO");
  const Token name = tokens_.take();
  check_name(name);
  Prototype interface;
  parse_interface(name.text, false, interface);
  constexpr FieldSpec kUrl{"the URL of an EXTERNPROTO", FieldType::kMFString, Access::kField, {}};
  const std::optional<Field> urls = values_.read(kUrl);
  Declaration declaration{.external = true,
                          .interface = interface.type.fields,
                          .urls = urls ? urls->as<std::string_view>() : std::span<const std::string_view>{},
                          .at = tokens_.position_of(name)};
  add_native(declaration, name.text);
  scope_->declarations[arena_.copy(name.text)] = declaration;
}

// A world may declare our own nodes, by their names or by URN, so that browsers that don't know them find a PROTO.
void TextParser::add_native(Declaration& declaration, std::string_view name) {
  if (std::ranges::find(kExtensionNodes, name) != std::end(kExtensionNodes)) declaration.native = find_node_type(name);
  for (const std::string_view url : declaration.urls) {
    if (url.starts_with(kExtensionUrn)) declaration.native = find_node_type(url.substr(kExtensionUrn.size()));
  }
  if (declaration.native != nullptr && !fits(declaration.interface, *declaration.native, declaration.at)) {
    declaration.native = nullptr;
  }
}

// Whether each field of `interface` is one of `type`, of the same type and with an access that serves it (4.9.2).
bool TextParser::fits(std::span<const FieldSpec> interface, const NodeType& type, Position at) {
  bool good = true;
  for (const FieldSpec& declared : interface) {
    const FieldSpec* field = find_field(type, declared.name);
    // An exposedField x has the events set_x and x_changed (4.7).
    const std::string_view name = declared.name;
    const FieldSpec* exposed = nullptr;
    if (declared.access == Access::kEventIn && name.starts_with("set_")) exposed = find_field(type, name.substr(4));
    if (declared.access == Access::kEventOut && name.ends_with("_changed")) {
      exposed = find_field(type, name.substr(0, name.size() - 8));
    }
    const bool event = field == nullptr && exposed != nullptr && exposed->access == Access::kExposedField;
    if (event && exposed->type == declared.type) continue;
    std::string why;
    if (field == nullptr) {
      Suggestion suggestion(declared.name);
      for (const FieldSpec& other : type.fields) suggestion.consider(other.name);
      why = "has no field " + quoted(declared.name) + did_you_mean(suggestion);
    } else if (field->type != declared.type) {
      why = "has " + quoted(declared.name) + " as " + std::string(name_of(field->type)) + ", not " +
            std::string(name_of(declared.type));
    } else if (field->access != declared.access &&
               !(field->access == Access::kExposedField && declared.access == Access::kField)) {
      why = "has " + quoted(declared.name) + " as " + std::string(name_of(field->access)) + ", not " +
            std::string(name_of(declared.access));
    } else {
      continue;
    }
    tokens_.error(at, "this declaration does not fit: " + std::string(type.name) + ' ' + why);
    good = false;
  }
  return good;
}

TextParser::Type TextParser::find_type(const Token& name) {
  for (Scope* scope = scope_; scope != nullptr; scope = scope->outer) {
    const auto it = scope->declarations.find(name.text);
    if (it == scope->declarations.end()) continue;
    Declaration& declaration = it->second;
    resolve(declaration, it->first);
    if (declaration.native != nullptr) return {declaration.native, nullptr};
    const Prototype* const prototype = declaration.prototype;
    return {prototype->not_found != nullptr ? prototype->not_found : &prototype->type, prototype};
  }
  return {find_node_type(name.text), nullptr};
}

// Looks for what an EXTERNPROTO declares. Where nothing is found its instances are empty nodes with its interface.
void TextParser::resolve(Declaration& declaration, std::string_view name) {
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  std::string tried;
  bool misfit = false;
  declaration.resolving = true;
  ++context_.resolving;
  for (const std::string_view url : declaration.urls) {
    std::string why;
    const Declaration* const found = find_in_library(url, declaration.at, why);
    if (found != nullptr) {
      const NodeType& type = found->native != nullptr ? *found->native : found->prototype->type;
      misfit = !fits(declaration.interface, type, declaration.at);
      if (misfit) break;
      declaration.native = found->native;
      declaration.prototype = found->prototype;
      break;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(url) + ": " + why;
  }
  declaration.resolving = false;
  --context_.resolving;
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  if (tried.empty()) tried = "it has no URL";
  if (!misfit) {
    tokens_.warning(declaration.at,
                    "EXTERNPROTO " + quoted(name) + " is not found, its instances stay empty: " + tried);
  }
  Prototype& empty = context_.prototypes.emplace_back();
  empty.not_found = &context_.document.own_types.emplace_back(
      NodeType{arena_.copy(name), kAnyClass, NodeRole::kPart, declaration.interface});
  empty.type = *empty.not_found;
  declaration.prototype = &empty;
}

const Declaration* TextParser::find_in_library(std::string_view url, Position at, std::string& why) {
  const std::size_t hash = std::min(url.find('#'), url.size());
  ParseContext::File* const file = open_file(url.substr(0, hash), at, why);
  if (file == nullptr) return nullptr;
  if (!file->library) {
    Body unused;
    file->library = TextParser(context_, file->begin, file->body, nesting_).parse_text(unused);
    context_.node_eighths -= 8 * unused.nodes.size();
  }
  context_.open_files.pop_back();
  if (hash < url.size()) {
    const auto it = file->library->find(url.substr(hash + 1));
    if (it == file->library->end()) {
      why = "it has no PROTO of that name";
      return nullptr;
    }
    if (it->second.resolving) {
      why = "it is declared by way of itself";
      tokens_.error(at, quoted(url) + ": " + why);
      return nullptr;
    }
    if (context_.resolving >= kMaxResolving) {
      why = "EXTERNPROTOs lead to one another more than " + std::to_string(kMaxResolving) + " times";
      tokens_.error(at, quoted(url) + ": " + why);
      return nullptr;
    }
    resolve(it->second, it->first);
    if (it->second.native != nullptr || it->second.prototype->not_found == nullptr) return &it->second;
    why = "it is not found there either";
    return nullptr;
  }
  // Without a name, the first PROTO of the file (4.9.3).
  Declaration* first = nullptr;
  for (auto& [name, declaration] : *file->library) {
    if (!declaration.external && (first == nullptr || declaration.at < first->at)) first = &declaration;
  }
  if (first == nullptr) why = "it has no PROTO";
  return first;
}

}  // namespace peerd::vrml
