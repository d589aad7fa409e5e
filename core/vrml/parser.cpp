#include "core/vrml/parser.hpp"

#include <algorithm>
#include <cassert>
#include <expected>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/gzip.hpp"
#include "core/vrml/name_table.hpp"
#include "core/vrml/prototype.hpp"
#include "core/vrml/token_stream.hpp"
#include "core/vrml/values.hpp"

namespace peerd::vrml {
namespace {

using enum TokenKind;

constexpr std::size_t kMaxOpenFiles = 32;              // an Inline in an Inline in ..; each is a recursion
constexpr std::uint32_t kAround = NodeRef::kNull - 1;  // a node that is still open, until close_around() knows it
constexpr std::size_t kFewEnough = 4096;               // a misspelt name among millions must not cost minutes
constexpr std::size_t kMaxFields = 4096;     // that a PROTO or a Script may declare: they are looked for one by one
constexpr std::uint32_t kMaxResolving = 64;  // EXTERNPROTOs that lead to one another; each is a recursion
constexpr std::string_view kOwnUrn = "urn:peerd:node:";

// The nodes of the seed's appendix C that a world may also declare, so that other browsers load it.
constexpr std::string_view kOwnNodes[] = {"CollisionInterest", "CollisionResponse", "KeySensor"};

// What a DEF names, from its node's '{' on.
struct Definition {
  const NodeType* type = nullptr;        // its fields as ROUTEs and the file's author see them; null where it was lost
  std::uint32_t node = NodeRef::kNull;   // kNull while it is open, and where an error made it unreadable
  const Prototype* prototype = nullptr;  // whose instance it is; its copy begins at `base`
  std::uint32_t base = 0;
  bool open = false;
};

// A PROTO by the name that it has in a scope; an EXTERNPROTO is looked for when it is used first.
struct Declaration {
  const Prototype* prototype = nullptr;
  const NodeType* native = nullptr;  // one of our own nodes stands for it
  bool external = false;
  bool resolving = false;  // it is being looked for
  std::span<const FieldSpec> interface {};
  std::span<const std::string_view> urls{};
  Position at = 0;
};
using Declarations = std::unordered_map<std::string_view, Declaration>;

struct RouteEnd {
  const Definition* node = nullptr;
  std::string_view name, event;
  Position at = 0;
};

// Where names hold: a file, a PROTO's body, a default value in its interface. PROTOs are seen from within, DEFs aren't
// (4.4.3, 4.8.1).
struct Scope {
  Scope* outer = nullptr;
  Body* body = nullptr;
  Prototype* prototype = nullptr;  // whose body this is, to which IS refers
  std::uint32_t id = 0;            // Node::scope
  std::deque<Definition> definitions{};
  NameTable<Definition*> names{};
  std::vector<std::pair<const Definition*, NodeRef*>> waiting{};  // Scripts' fields that refer to open ones
  Declarations declarations{};
  std::vector<std::pair<RouteEnd, RouteEnd>> routes{};
};

// What all texts of a world share.
struct Reading {
  Document& document;
  Problems& problems;
  const ParseOptions& options;
  Body world{};
  std::deque<Prototype> prototypes{};
  struct File {
    Position begin = 0;
    std::size_t body = 0;  // offset behind its header
    bool readable = false;
    std::string why{};                              // it is not
    std::optional<std::vector<NodeRef>> content{};  // as an Inline, in `world`
    std::optional<Declarations> library{};          // as what EXTERNPROTOs look into
  };
  std::map<std::string, File, std::less<>> files{};  // by LoadedFile::name
  std::vector<std::string_view> open_files{};
  std::uint64_t text_bytes = 0;
  std::uint64_t node_eighths = 0;  // of all bodies
  std::uint32_t resolving = 0;     // EXTERNPROTOs that lead to one another
  bool too_many_nodes = false;

  // References and ROUTEs are smaller than nodes, and can be more: eight of them count as a node.
  [[nodiscard]] bool room_for(std::uint64_t nodes, std::uint64_t references, Position at) {
    const std::uint64_t eighths = 8 * nodes + references;
    if (node_eighths + eighths <= 8 * std::uint64_t{options.limits.nodes}) {
      node_eighths += eighths;
      return true;
    }
    if (!std::exchange(too_many_nodes, true)) {
      problems.error(at, "with this node the world has more than " + std::to_string(options.limits.nodes) +
                             " nodes, PROTOs expanded");
    }
    return false;
  }
};

struct OpenText {
  Position begin = 0;
  std::size_t body = 0;  // offset behind its header
};

// Unpacks a text, checks its header and takes it among the sources.
std::expected<OpenText, std::string> open_text(Reading& reading, Source source) {
  const std::uint64_t left =
      reading.options.limits.text_bytes - std::min(reading.text_bytes, reading.options.limits.text_bytes);
  std::expected<Header, std::string> header = std::unexpected("");
  if (is_gzip(source.text)) {
    std::expected<std::string, std::string> unpacked = gunzip(source.text, left);
    if (unpacked) {
      source.owned = std::make_shared<const std::string>(std::move(*unpacked));
      source.text = *source.owned;
      header = read_header(source.text);
    } else {
      header = std::unexpected(unpacked.error());
    }
  } else if (source.text.size() > left) {
    header = std::unexpected("it is larger than " + std::to_string(left) + " bytes, more than this reader takes");
  } else {
    header = read_header(source.text);
  }
  reading.text_bytes += source.text.size();
  const std::optional<Position> begin = reading.problems.open(std::move(source));
  if (!header) return std::unexpected(header.error());
  if (!begin) return std::unexpected("its files together are larger than 4 GiB, more than this reader takes");
  if (!header->remark.empty()) reading.problems.warning(*begin, std::string(header->remark));
  return OpenText{*begin, header->end};
}

// About how many nodes a text has, so that their memory is neither moved nor left empty: its braces, but no more than
// fit in it by far. Few in most of a large world's bytes, so that looking for them costs next to nothing.
std::size_t guess_nodes(std::string_view text, const ReadLimits& limits) {
  constexpr std::size_t kFewestBytes = 16;
  const std::size_t most = std::min<std::size_t>(text.size() / kFewestBytes, limits.nodes);
  std::size_t count = 0;
  for (std::size_t at = text.find('{'); at != std::string_view::npos && count < most; at = text.find('{', at + 1))
    ++count;
  return count;
}

class Parser {
 public:
  Parser(Reading& reading, Position text_begin, std::size_t begin, std::uint32_t nesting)
      : reading_(reading),
        arena_(reading.document.arena),
        problems_(reading.problems),
        tokens_(problems_.text_of(text_begin), text_begin, begin, problems_),
        values_(tokens_, arena_, problems_),
        nesting_(nesting) {
    values_.set_parser([this](const FieldSpec& spec) { return parse_node_value(spec); },
                       [this](std::string_view word) { return is_field_of_open_node(word); });
  }

  // The whole text into `body`; a live one is the world's, where Inlines are loaded.
  Declarations parse_text(Body& body);

 private:
  struct PendingLink {
    const FieldSpec* outer;
    const FieldSpec* inner;
    Position at;
  };
  // A node between its braces.
  struct Open {
    const NodeType* type = nullptr;
    Open* outer = nullptr;
    std::size_t first_field = 0;  // of it in fields_
    std::vector<PendingLink> links{};
    std::list<FieldSpec> own_fields{};  // a Script's; they stay where they are, and most nodes have none
    Definition* definition = nullptr;
    bool damaged = false;
  };
  struct Type {
    const NodeType* type = nullptr;
    const Prototype* prototype = nullptr;
  };

  bool parse_statement();
  void parse_proto();
  void skip_declaration(const std::string& keyword);
  void skip_to_declaration();
  void parse_externproto();
  void check_name(const Token& name);
  bool parse_interface(std::string_view name, bool with_values, Prototype& prototype);
  void parse_body_of(Prototype& prototype, std::string_view name);
  void add_native(Declaration& declaration, std::string_view name);
  bool fits(std::span<const FieldSpec> interface, const NodeType& type, Position at);
  Type find_type(const Token& name);
  void resolve(Declaration& declaration, std::string_view name);
  const Declaration* look_into_library(std::string_view url, Position at, std::string& why);
  void close(Scope& scope);
  void too_many(Position at) {
    tokens_.error(
        at, "with this field there are more than " + std::to_string(kMaxFields) + ", more than this reader takes");
  }

  void parse_route();
  std::optional<RouteEnd> parse_route_end();
  void skip_line_of(const Token& first);
  [[nodiscard]] Suggestion names_like(std::string_view name) const;
  struct Event {
    const FieldSpec* spec = nullptr;
    std::vector<std::pair<std::uint32_t, const FieldSpec*>> nodes{};  // in the scope's body
  };
  Event find_event(const RouteEnd& end, bool sends);
  void add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to);

  std::optional<NodeRef> parse_node_value(const FieldSpec& spec);
  NodeRef parse_node();
  NodeRef parse_use();
  NodeRef parse_node_body(const Token& def, const Token& type_name, Position at);
  NodeRef close_node(Open& open, const Token& def, Position at);
  NodeRef close_instance(Open& open, const Prototype& prototype, const Token& def, Position at);
  void finish_script(Open& open);
  void parse_fields(Open& open);
  void parse_field(Open& open);
  void parse_is(Open& open, const FieldSpec& spec, Access access, Position at);
  void parse_script_declaration(Open& open);
  void parse_unknown_field(Open& open, const Token& name);
  void report_unknown_type(const Token& name);
  bool is_field_of_open_node(std::string_view word) const;
  const FieldSpec* find_field_of(const Open& open, std::string_view name) const;
  void skip_value() { lose(values_.skip()); }
  void skip_balanced() { lose(tokens_.skip_balanced()); }
  void lose(const std::vector<std::string_view>& names) {
    for (const std::string_view name : names) lose(name);
  }
  void lose(std::string_view name) {
    if (!name.empty()) define(name);
  }
  Definition& define(std::string_view name);
  [[nodiscard]] bool live() const { return scope_->body == &reading_.world; }

  void load_inlines_of(const Prototype& prototype, std::span<const Field> given);
  [[nodiscard]] bool is_for_later(Position inline_at, const Field* box_size) const;
  void fill_inline(Node& node);
  const std::vector<NodeRef>* load_content(const Field& url);
  Reading::File* open_file(std::string_view url, Position at, std::string& why);
  bool is_open(std::string_view name) const;

  Reading& reading_;
  Arena& arena_;
  Problems& problems_;
  TokenStream tokens_;
  ValueReader values_;
  Scope* scope_ = nullptr;
  Open* open_ = nullptr;                  // the innermost open node
  std::vector<Field> fields_;             // of all open nodes
  std::vector<Definition*> script_uses_;  // open ones that the Script field in hand names, in order
  std::uint32_t nesting_;                 // of nodes and PROTOs, through files: each is a recursion
};

Definition& Parser::define(std::string_view name) {
  scope_->definitions.emplace_back();
  scope_->names[name] = &scope_->definitions.back();
  return scope_->definitions.back();
}

Declarations Parser::parse_text(Body& body) {
  Scope scope{.body = &body};
  if (reading_.open_files.size() > 1 || &body != &reading_.world) scope.id = body.scopes++;
  scope_ = &scope;
  while (!tokens_.at(kEnd)) {
    if (tokens_.at(kWord)) {
      const Position at = tokens_.position();
      if (parse_statement()) continue;
      const NodeRef ref = parse_node();
      if (ref.is_node() && (body.nodes[ref.index].type->classes & kChild) == 0) {
        tokens_.warning(
            at, std::string(body.nodes[ref.index].type->name) + " at the top level is not part of the scene by itself");
      }
      body.roots.push_back(ref);
      continue;
    }
    tokens_.error(tokens_.position(), "expected a node, found " + described(tokens_.peek()));
    while (!tokens_.at(kEnd) && !tokens_.at(kWord)) tokens_.take();
  }
  close(scope);
  return std::move(scope.declarations);
}

bool Parser::parse_statement() {
  if (tokens_.at_word("PROTO")) return parse_proto(), true;
  if (tokens_.at_word("EXTERNPROTO")) return parse_externproto(), true;
  if (tokens_.at_word("ROUTE")) return parse_route(), true;
  return false;
}

// PROTO and EXTERNPROTO

void Parser::check_name(const Token& name) {
  const bool own = std::ranges::find(kOwnNodes, name.text) != std::end(kOwnNodes);
  if (find_node_type(name.text) != nullptr && !own) {
    tokens_.error(tokens_.position_of(name),
                  quoted(name.text) + " is a node of the standard: no PROTO can take its name");
  } else if (scope_->declarations.contains(name.text)) {
    tokens_.warning(tokens_.position_of(name),
                    "a PROTO " + quoted(name.text) + " is there already; this one counts from here on");
  }
}

// One without a name.
void Parser::skip_declaration(const std::string& keyword) {
  tokens_.error(tokens_.position(), "expected a name after " + keyword + ", found " + described(tokens_.peek()));
  if (tokens_.at(kWord)) tokens_.take();
  if (tokens_.at(kOpenBracket)) skip_balanced();
  if (tokens_.at(kOpenBracket) || tokens_.at(kOpenBrace)) return skip_balanced();
  if (tokens_.at(kString)) tokens_.take();
}

// To the next declaration of an interface, or to its end.
void Parser::skip_to_declaration() {
  while (!tokens_.at(kEnd) && !tokens_.at(kCloseBracket) && !tokens_.at(kCloseBrace)) {
    if (tokens_.at(kWord) && find_access(tokens_.peek().text)) return;
    if (tokens_.at(kOpenBracket) || tokens_.at(kOpenBrace)) {
      skip_balanced();
    } else {
      tokens_.take();
    }
  }
}

void Parser::parse_proto() {
  const Token keyword = tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return skip_declaration("PROTO");
  const Token name = tokens_.take();
  check_name(name);
  Prototype& prototype = reading_.prototypes.emplace_back();
  prototype.type = {arena_.copy(name.text), kAnyClass, Meaning::kPart, {}};
  if (nesting_ >= kMaxNesting) {
    tokens_.error(tokens_.position_of(keyword),
                  "PROTOs and nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    if (tokens_.at(kOpenBracket)) skip_balanced();
    if (tokens_.at(kOpenBrace)) skip_balanced();
    return;
  }
  ++nesting_;
  Open* const outer_open = std::exchange(open_, nullptr);
  parse_interface(name.text, true, prototype);
  parse_body_of(prototype, name.text);
  open_ = outer_open;
  --nesting_;
  Declaration declaration{.prototype = &prototype, .interface = prototype.type.fields, .at = tokens_.position_of(name)};
  add_native(declaration, name.text);
  scope_->declarations[prototype.type.name] = declaration;
}

// The declarations between '[' and ']', with default values for a PROTO. Those that can be read are kept.
bool Parser::parse_interface(std::string_view name, bool with_values, Prototype& prototype) {
  if (!tokens_.at(kOpenBracket)) {
    tokens_.error(tokens_.position(),
                  "expected '[' and the interface of " + quoted(name) + ", found " + described(tokens_.peek()));
    return false;
  }
  const Token bracket = tokens_.take();
  std::vector<FieldSpec> specs;
  std::vector<std::optional<Field>> defaults;
  std::unordered_set<std::string_view> names;
  const auto known = [&](std::string_view field) { return names.contains(field); };
  // 4.7: an exposedField x is also set_x and x_changed.
  const auto conflict = [&](std::string_view field, Access access) {
    if (known(field)) return true;
    if (access == Access::kExposedField) {
      return known("set_" + std::string(field)) || known(std::string(field) + "_changed");
    }
    const auto exposed = [&](std::string_view base) {
      const auto it = std::ranges::find(specs, base, &FieldSpec::name);
      return it != specs.end() && it->access == Access::kExposedField;
    };
    return (field.starts_with("set_") && exposed(field.substr(4))) ||
           (field.ends_with("_changed") && exposed(field.substr(0, field.size() - 8)));
  };
  bool good = true;
  while (!tokens_.at(kCloseBracket)) {
    const auto access = tokens_.at(kWord) ? find_access(tokens_.peek().text) : std::nullopt;
    if (!access) {
      good = false;
      if (tokens_.at(kEnd)) {
        tokens_.report_unclosed(tokens_.position_of(bracket), "interface", ']');
        break;
      }
      tokens_.error(tokens_.position(), "expected eventIn, eventOut, field, exposedField or ']' in the interface of " +
                                            quoted(name) + ", found " + described(tokens_.peek()));
      if (tokens_.at(kCloseBrace) || tokens_.at(kOpenBrace)) break;  // the ']' is missing
      skip_to_declaration();
      continue;
    }
    tokens_.take();
    const auto type = tokens_.at(kWord) ? find_field_type(tokens_.peek().text) : std::nullopt;
    if (!type) {
      good = false;
      Suggestion suggestion(tokens_.peek().text);
      for (int t = 0; t <= static_cast<int>(FieldType::kMFVec3f); ++t)
        suggestion.consider(name_of(static_cast<FieldType>(t)));
      tokens_.error(tokens_.position(),
                    "expected a field type, found " + described(tokens_.peek()) + did_you_mean(suggestion));
      skip_to_declaration();
      continue;
    }
    tokens_.take();
    if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
      good = false;
      tokens_.error(tokens_.position(), "expected the name of a field, found " + described(tokens_.peek()));
      skip_to_declaration();
      continue;
    }
    const Token field = tokens_.take();
    if (conflict(field.text, *access)) {
      good = false;
      tokens_.error(tokens_.position_of(field),
                    quoted(field.text) + " is in the interface of " + quoted(name) + " already");
    }
    const FieldSpec spec{arena_.copy(field.text), *type, *access, {}, Range::kAny, kAnyClass};
    std::optional<Field> value;
    const bool wanted = with_values && has_value(*access);
    if (wanted) {
      Scope scope{.outer = scope_, .body = &prototype.body};
      Scope* const outer = std::exchange(scope_, &scope);
      value = values_.read(spec);
      close(scope);
      scope_ = outer;
      if (!value) skip_to_declaration();
    }
    good = good && (value.has_value() || !wanted);
    if (known(field.text)) continue;
    if (specs.size() == kMaxFields) too_many(tokens_.position_of(field));
    if (specs.size() >= kMaxFields) continue;
    names.insert(spec.name);
    specs.push_back(spec);
    defaults.push_back(value);
  }
  tokens_.accept(kCloseBracket);
  const auto kept = arena_.copy(std::span<const FieldSpec>(specs));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (defaults[i]) defaults[i]->spec = &kept[i];
  }
  prototype.type.fields = kept;
  prototype.defaults = std::move(defaults);
  return good;
}

void Parser::parse_body_of(Prototype& prototype, std::string_view name) {
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
}

void Parser::parse_externproto() {
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
void Parser::add_native(Declaration& declaration, std::string_view name) {
  if (std::ranges::find(kOwnNodes, name) != std::end(kOwnNodes)) declaration.native = find_node_type(name);
  for (const std::string_view url : declaration.urls) {
    if (url.starts_with(kOwnUrn)) declaration.native = find_node_type(url.substr(kOwnUrn.size()));
  }
  if (declaration.native != nullptr && !fits(declaration.interface, *declaration.native, declaration.at)) {
    declaration.native = nullptr;
  }
}

// Whether each field of `interface` is one of `type`, of the same type and with an access that serves it (4.9.2).
bool Parser::fits(std::span<const FieldSpec> interface, const NodeType& type, Position at) {
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

Parser::Type Parser::find_type(const Token& name) {
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
void Parser::resolve(Declaration& declaration, std::string_view name) {
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  std::string tried;
  bool misfit = false;
  declaration.resolving = true;
  ++reading_.resolving;
  for (const std::string_view url : declaration.urls) {
    std::string why;
    const Declaration* const found = look_into_library(url, declaration.at, why);
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
  --reading_.resolving;
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  if (tried.empty()) tried = "it has no URL";
  if (!misfit) {
    tokens_.warning(declaration.at,
                    "EXTERNPROTO " + quoted(name) + " is not found, its instances stay empty: " + tried);
  }
  Prototype& empty = reading_.prototypes.emplace_back();
  empty.not_found = &reading_.document.own_types.emplace_back(
      NodeType{arena_.copy(name), kAnyClass, Meaning::kPart, declaration.interface});
  empty.type = *empty.not_found;
  declaration.prototype = &empty;
}

const Declaration* Parser::look_into_library(std::string_view url, Position at, std::string& why) {
  const std::size_t hash = std::min(url.find('#'), url.size());
  Reading::File* const file = open_file(url.substr(0, hash), at, why);
  if (file == nullptr) return nullptr;
  if (!file->library) {
    Body unused;
    file->library = Parser(reading_, file->begin, file->body, nesting_).parse_text(unused);
    reading_.node_eighths -= 8 * unused.nodes.size();
  }
  reading_.open_files.pop_back();
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
    if (reading_.resolving >= kMaxResolving) {
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

// Other files

bool Parser::is_open(std::string_view name) const {
  return std::ranges::find(reading_.open_files, name) != reading_.open_files.end();
}

// The file behind a URL, read and unpacked, now at the end of open_files; or null, and why.
Reading::File* Parser::open_file(std::string_view url, Position at, std::string& why) {
  if (!reading_.options.load) {
    why = "no other file is read here";
    return nullptr;
  }
  std::expected<LoadedFile, std::string> loaded = reading_.options.load(url, problems_.name_of(at));
  if (!loaded) {
    why = loaded.error();
    return nullptr;
  }
  if (is_open(loaded->name)) {
    why = "that file is being read already: it contains itself";
    tokens_.error(at, quoted(url) + ": " + why);
    return nullptr;
  }
  if (reading_.open_files.size() >= kMaxOpenFiles) {
    why = "files are nested more than " + std::to_string(kMaxOpenFiles) + " deep";
    tokens_.error(at, quoted(url) + ": " + why);
    return nullptr;
  }
  const auto [it, is_new] = reading_.files.try_emplace(loaded->name);
  Reading::File& file = it->second;
  if (is_new) {
    Source source{it->first, {}, std::make_shared<const std::string>(std::move(loaded->bytes))};
    source.text = *source.owned;
    const auto opened = open_text(reading_, std::move(source));
    if (opened) {
      file = {.begin = opened->begin, .body = opened->body, .readable = true};
    } else {
      file.why = opened.error();
    }
  }
  if (!file.readable) {
    why = file.why;
    return nullptr;
  }
  reading_.open_files.push_back(it->first);
  return &file;
}

// The nodes that an Inline stands for, from the first of its URLs behind which there is a file.
const std::vector<NodeRef>* Parser::load_content(const Field& url) {
  std::string tried;
  const std::size_t errors = problems_.errors();
  for (const std::string_view one : url.as<std::string_view>()) {
    std::string why;
    Reading::File* const file = open_file(one.substr(0, one.find('#')), url.at, why);
    if (file != nullptr) {
      if (!file->content) {
        const std::size_t first = reading_.world.roots.size();
        Parser(reading_, file->begin, file->body, nesting_).parse_text(reading_.world);
        auto& roots = reading_.world.roots;
        file->content.emplace(roots.begin() + static_cast<std::ptrdiff_t>(first), roots.end());
        roots.resize(first);
      }
      reading_.open_files.pop_back();
      return &*file->content;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(one) + ": " + why;
  }
  if (!tried.empty() && problems_.errors() == errors) {
    tokens_.warning(url.at, "this Inline stays empty: " + tried);
  }
  return nullptr;
}

// Before a prototype's Inlines come into the world: nodes stand behind what they refer to.
void Parser::load_inlines_of(const Prototype& prototype, std::span<const Field> given) {
  for (std::uint32_t i = 0; i < prototype.body.nodes.size(); ++i) {
    const Node& node = prototype.body.nodes[i];
    if (node.type->meaning != Meaning::kInline) continue;
    const auto value = [&](std::string_view name) {
      const Field* field = node.find(name);
      for (const IsLink& link : prototype.links) {
        if (link.node != i || link.inner->name != name) continue;
        const auto it = std::ranges::find(given, link.outer, &Field::spec);
        const auto& otherwise = prototype.defaults[static_cast<std::size_t>(link.outer - prototype.type.fields.data())];
        field = it != given.end() ? &*it : otherwise ? &*otherwise : nullptr;
      }
      return field;
    };
    const Field* url = value("url");
    if (url != nullptr && !is_for_later(node.at, value("bboxSize"))) static_cast<void>(load_content(*url));
  }
}

bool Parser::is_for_later(Position inline_at, const Field* box_size) const {
  if (!reading_.options.inlines_later || box_size == nullptr) return false;
  const std::span<const float> size = box_size->as<float>();
  const bool sized = size[0] >= 0 && size[1] >= 0 && size[2] >= 0;
  return sized && !reading_.options.inlines_now.contains(problems_.place_of(inline_at));
}

void Parser::fill_inline(Node& node) {
  const Field* url = node.find("url");
  if (url == nullptr) return;
  if (is_for_later(node.at, node.find("bboxSize"))) return;
  const std::vector<NodeRef>* content = load_content(*url);
  std::vector<Field> fields(node.given().begin(), node.given().end());
  const auto refs = arena_.copy(content != nullptr ? std::span<const NodeRef>(*content) : std::span<const NodeRef>());
  fields.push_back({&inline_content(), refs.data(), static_cast<std::uint32_t>(refs.size()), url->at});
  const auto kept = arena_.copy(std::span<const Field>(fields));
  node.fields = kept.data();
  node.field_count = static_cast<std::uint32_t>(kept.size());
}

// ROUTE

void Parser::parse_route() {
  const Token keyword = tokens_.take();
  const std::optional<RouteEnd> from = parse_route_end();
  if (!from && !tokens_.at_word("TO")) return skip_line_of(keyword);
  if (!tokens_.at_word("TO")) {
    tokens_.error(tokens_.position(), "expected TO and where the ROUTE goes, found " + described(tokens_.peek()));
    return skip_line_of(keyword);
  }
  tokens_.take();
  const std::optional<RouteEnd> to = parse_route_end();
  if (!to) return skip_line_of(keyword);
  if (from && from->node != nullptr && to->node != nullptr) scope_->routes.emplace_back(*from, *to);
}

// A broken ROUTE ends with its line, as nearly all do.
void Parser::skip_line_of(const Token& first) {
  std::uint32_t seen = first.offset;
  while (tokens_.at(kWord) || tokens_.at(kPeriod) || tokens_.at(kNumber)) {
    const std::string_view text = problems_.text_of(tokens_.position());
    const std::string_view between = text.substr(seen, tokens_.peek().offset - seen);
    if (between.find_first_of("\r\n") != std::string_view::npos) return;
    seen = tokens_.take().offset;
  }
}

// NODE.EVENT; nothing where it is not written so. Its node is null where no node has that name.
std::optional<RouteEnd> Parser::parse_route_end() {
  const auto expected = [&](const std::string& what) {
    tokens_.error(tokens_.position(), "expected " + what + ", found " + described(tokens_.peek()));
    return std::nullopt;
  };
  RouteEnd end;
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return expected("NODE.EVENT of a ROUTE");
  const Token name = tokens_.take();
  end.name = name.text;
  if (!tokens_.accept(kPeriod)) return expected("'.' and an event of " + quoted(name.text));
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) return expected("an event of " + quoted(name.text));
  end.at = tokens_.position();
  end.event = tokens_.take().text;
  if (Definition* const* const named = scope_->names.find(name.text)) {
    end.node = *named;
  } else {
    tokens_.error(tokens_.position_of(name), "ROUTE names " + quoted(name.text) + ", which no DEF before it names" +
                                                 did_you_mean(names_like(name.text)));
  }
  return end;
}

// Of the names in force here the one that was probably meant.
Suggestion Parser::names_like(std::string_view name) const {
  Suggestion suggestion(name);
  std::vector<std::string_view> names;  // in an order that doesn't depend on where they stand
  if (scope_->names.size() <= kFewEnough) {
    for (const auto& [known, definition] : scope_->names) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  return suggestion;
}

// The field that an event's name stands for: itself, or the exposedField behind set_x and x_changed (4.7).
Parser::Event Parser::find_event(const RouteEnd& end, bool sends) {
  const Definition& definition = *end.node;
  if (definition.type == nullptr || definition.node == NodeRef::kNull) return {};  // what was lost is reported
  const NodeType& type = *definition.type;
  const auto serves = [&](const FieldSpec& field) {
    return sends ? sends_events(field.access) : takes_events(field.access);
  };
  const FieldSpec* found = nullptr;
  const FieldSpec* exact = find_field(type, end.event);
  if (exact != nullptr && exact->access == Access::kContent) exact = nullptr;
  if (exact != nullptr && serves(*exact)) {
    found = exact;
  } else {
    // set_ and _changed may be left out, and an exposedField has both (4.7, 4.10.2).
    std::string_view base;
    if (sends && end.event.ends_with("_changed")) base = end.event.substr(0, end.event.size() - 8);
    if (!sends && end.event.starts_with("set_")) base = end.event.substr(4);
    const FieldSpec* field = base.empty() ? nullptr : find_field(type, base);
    if (field != nullptr && field->access == Access::kExposedField) found = field;
    if (exact == nullptr && found == nullptr) {
      field = find_field(type, sends ? std::string(end.event) + "_changed" : "set_" + std::string(end.event));
      if (field != nullptr && serves(*field)) found = field;
    }
  }
  if (found == nullptr) {
    std::string why;
    if (exact != nullptr) {
      why = quoted(end.event) + " is an " + std::string(name_of(exact->access)) + " of " + std::string(type.name);
      if (exact->access == Access::kField) why.replace(why.find(" is an "), 7, " is a ");
      why += sends ? ": it sends no events" : ": it takes no events";
    } else {
      Suggestion suggestion(end.event);
      for (const FieldSpec& field : type.fields) {
        if (serves(field)) suggestion.consider(field.name);
      }
      why = std::string(type.name) + (sends ? " sends no event " : " takes no event ") + quoted(end.event) +
            did_you_mean(suggestion);
    }
    tokens_.error(end.at, why);
    return {};
  }
  Event event{found};
  if (definition.prototype == nullptr || definition.prototype->not_found != nullptr) {
    event.nodes.emplace_back(definition.node, found);
    return event;
  }
  for (const IsLink& link : definition.prototype->links) {
    const bool inner = sends ? sends_events(link.inner->access) : takes_events(link.inner->access);
    if (link.outer == found && inner) event.nodes.emplace_back(definition.base + link.node, link.inner);
  }
  return event;
}

void Parser::add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to) {
  const Event source = find_event(from, true);
  const Event target = find_event(to, false);
  if (source.spec == nullptr || target.spec == nullptr) return;
  if (source.spec->type != target.spec->type) {
    tokens_.error(to.at, "this ROUTE goes from " + std::string(name_of(source.spec->type)) + " to " +
                             std::string(name_of(target.spec->type)) + ": both must be of one type");
    return;
  }
  for (const auto& [from_node, from_field] : source.nodes) {
    for (const auto& [to_node, to_field] : target.nodes) {
      if (!reading_.room_for(0, 2, from.at)) return;
      scope.body->routes.push_back({from_node, to_node, from_field, to_field, from.at});
    }
  }
}

void Parser::close(Scope& scope) {
  for (const auto& [from, to] : scope.routes) add_routes(scope, from, to);
  const bool lost =
      std::ranges::any_of(scope.definitions, [](const Definition& d) { return d.node == NodeRef::kNull; });
  if (!live() || !lost) return;
  for (const auto& [name, definition] : scope.names) {
    if (definition->node == NodeRef::kNull) reading_.document.lost_names.push_back(arena_.copy(name));
  }
}

// Nodes

std::optional<NodeRef> Parser::parse_node_value(const FieldSpec& spec) {
  if (parse_statement()) return std::nullopt;
  NodeRef ref = parse_node();
  const Field one{&spec, &ref, 1, ref.at};
  if (ref.is_node() && ref.index != kAround && !check_nodes(spec, one, scope_->body->nodes, problems_))
    ref.index = NodeRef::kNull;
  return ref;
}

NodeRef Parser::parse_node() {
  if (tokens_.at_word("USE")) return parse_use();
  const Position at = tokens_.position();
  Token def;
  if (tokens_.at_word("DEF")) {
    tokens_.take();
    if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
      tokens_.error(tokens_.position(), "expected a name after DEF, found " + described(tokens_.peek()));
      if (!tokens_.at(kWord) && !tokens_.at(kNumber)) return {NodeRef::kNull, at};
      tokens_.take();
    } else {
      def = tokens_.take();
    }
  }
  if (!tokens_.at(kWord)) {
    tokens_.error(tokens_.position(), "expected a node type, found " + described(tokens_.peek()));
    lose(def.text);
    return {NodeRef::kNull, at};
  }
  const Token type_name = tokens_.take();
  return parse_node_body(def, type_name, at);
}

NodeRef Parser::parse_use() {
  const Token use = tokens_.take();
  const NodeRef null{NodeRef::kNull, tokens_.position_of(use)};
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
    tokens_.error(tokens_.position(), "expected a DEF name after USE, found " + described(tokens_.peek()));
    return null;
  }
  const Token name = tokens_.take();
  Definition* const* const named = scope_->names.find(name.text);
  if (named == nullptr && scope_->prototype == nullptr && scope_->outer != nullptr) {
    // A default value stands outside of its PROTO's body, so it may USE what stands before it; as a copy of its own.
    Definition* const* const around = scope_->outer->names.find(name.text);
    if (around != nullptr && !(*around)->open && (*around)->node != NodeRef::kNull) {
      const std::size_t before = scope_->body->nodes.size();
      const std::uint32_t copy = copy_node(*scope_->outer->body, (*around)->node, *scope_->body, arena_);
      const bool room = reading_.room_for(scope_->body->nodes.size() - before, 0, null.at);
      return {room ? copy : NodeRef::kNull, null.at};
    }
  }
  if (named == nullptr) {
    tokens_.error(tokens_.position_of(name), "USE of " + quoted(name.text) + ", which no DEF before it names" +
                                                 did_you_mean(names_like(name.text)));
    return null;
  }
  Definition& definition = **named;
  if (definition.open) {
    // A Script may be told of itself and of what it stands in (4.12): it doesn't contain what its fields name.
    if (open_ != nullptr && open_->type->meaning == Meaning::kScript) {
      script_uses_.push_back(&definition);
      return {kAround, null.at};
    }
    tokens_.error(tokens_.position_of(name),
                  "USE of " + quoted(name.text) + " inside that node itself: a node cannot contain itself");
    return null;
  }
  return {definition.node, null.at};
}

void Parser::report_unknown_type(const Token& name) {
  const Position at = tokens_.position_of(name);
  for (Scope* scope = scope_; scope != nullptr; scope = scope->outer) {
    if (scope->prototype != nullptr && scope->prototype->type.name == name.text) {
      return tokens_.error(at, quoted(name.text) + " is used inside its own PROTO: it would contain itself");
    }
  }
  Suggestion suggestion(name.text);
  for (const NodeType& type : node_types()) suggestion.consider(type.name);
  std::vector<std::string_view> names;
  for (Scope* scope = scope_; scope != nullptr; scope = scope->outer) {
    if (scope->declarations.size() > kFewEnough) continue;
    for (const auto& [known, declaration] : scope->declarations) names.push_back(known);
  }
  std::ranges::sort(names);
  for (const std::string_view known : names) suggestion.consider(known);
  const bool node = tokens_.at(kOpenBrace);
  tokens_.error(
      at, (node ? "unknown node type " : "expected a node, found ") + quoted(name.text) + did_you_mean(suggestion));
}

NodeRef Parser::parse_node_body(const Token& def, const Token& type_name, Position at) {
  Type type = find_type(type_name);
  if (type.type == nullptr) report_unknown_type(type_name);
  if (type.type != nullptr && !tokens_.at(kOpenBrace)) {
    tokens_.error(tokens_.position(),
                  "expected '{' after " + std::string(type.type->name) + ", found " + described(tokens_.peek()));
  } else if (type.type != nullptr && nesting_ >= kMaxNesting) {
    tokens_.error(tokens_.position_of(type_name),
                  "nodes are nested more than " + std::to_string(kMaxNesting) + " deep");
    type = {};
  }
  if (type.type == nullptr || !tokens_.at(kOpenBrace)) {
    lose(def.text);
    if (tokens_.at(kOpenBrace)) {
      skip_balanced();
    } else if (nesting_ == 0) {
      while (!tokens_.at(kEnd) &&
             !(tokens_.at(kWord) && (is_keyword(tokens_.peek().text) || find_node_type(tokens_.peek().text)))) {
        tokens_.take();
      }
    }
    return {NodeRef::kNull, at};
  }

  Open open{.type = type.type, .outer = open_, .first_field = fields_.size()};
  if (!def.text.empty()) {
    open.definition = &define(def.text);
    open.definition->type = type.type;
    open.definition->open = true;
  }
  open_ = &open;
  ++nesting_;
  parse_fields(open);
  --nesting_;
  open_ = open.outer;
  const bool copied = type.prototype != nullptr && type.prototype->not_found == nullptr;
  const NodeRef ref = copied ? close_instance(open, *type.prototype, def, at) : close_node(open, def, at);
  fields_.resize(open.first_field);
  if (open.definition != nullptr) {
    open.definition->node = ref.index;
    open.definition->open = false;
    std::erase_if(scope_->waiting, [&](const auto& waiting) {
      if (waiting.first == open.definition) waiting.second->index = ref.index;
      return waiting.first == open.definition;
    });
  }
  return ref;
}

NodeRef Parser::close_node(Open& open, const Token& def, Position at) {
  if (!reading_.room_for(1, 0, at)) return {NodeRef::kNull, at};
  if (!open.own_fields.empty()) finish_script(open);
  Body& body = *scope_->body;
  const auto fields = arena_.copy(std::span<const Field>(fields_).subspan(open.first_field));
  Node node{.type = open.type,
            .fields = fields.data(),
            .def = def.text.empty() ? std::string_view{} : arena_.copy(def.text),
            .at = at,
            .scope = scope_->id,
            .field_count = static_cast<std::uint32_t>(fields.size()),
            .damaged = open.damaged};
  if (node.type->meaning == Meaning::kInline && live()) fill_inline(node);
  const auto index = static_cast<std::uint32_t>(body.nodes.size());
  for (const PendingLink& link : open.links) {
    const FieldSpec* inner = find_field(*open.type, link.inner->name);
    scope_->prototype->links.push_back({link.outer, index, inner, link.at});
  }
  for (const Field& field : node.given()) {
    if (field.spec->type == FieldType::kSFNode || field.spec->type == FieldType::kMFNode)
      body.references += field.count;
  }
  body.nodes.push_back(node);
  return {index, at};
}

// An instance stands in the text as a node and in the document as a copy of the prototype's body.
NodeRef Parser::close_instance(Open& open, const Prototype& prototype, const Token& def, Position at) {
  const std::span<const Field> given = std::span<const Field>(fields_).subspan(open.first_field);
  const Body& copied = prototype.body;
  if (!reading_.room_for(copied.nodes.size(), copied.references + 2 * copied.routes.size(), at))
    return {NodeRef::kNull, at};
  if (live()) load_inlines_of(prototype, given);
  Body& body = *scope_->body;
  const std::size_t first = body.nodes.size();
  const Expansion copy = expand(prototype, given, body, arena_, problems_);
  if (live()) {
    for (std::size_t i = first; i < body.nodes.size(); ++i) {
      if (body.nodes[i].type->meaning == Meaning::kInline) fill_inline(body.nodes[i]);
    }
  }
  for (const PendingLink& link : open.links) {
    for (const IsLink& inner : prototype.links) {
      if (inner.outer != link.inner) continue;
      if (!reading_.room_for(0, 2, at)) break;
      scope_->prototype->links.push_back({link.outer, copy.base + inner.node, inner.inner, link.at});
    }
  }
  if (open.definition != nullptr) {
    open.definition->prototype = &prototype;
    open.definition->base = copy.base;
  }
  if (copy.root != NodeRef::kNull) {
    Node& root = body.nodes[copy.root];
    root.damaged |= open.damaged;
    if (!def.text.empty()) {
      // What the PROTO calls its first node is known inside of it only.
      if (!root.def.empty()) body.inner_names.push_back({root.scope, root.def, copy.root});
      root.def = arena_.copy(def.text);
      root.scope = scope_->id;
    }
  }
  return {copy.root, at};
}

// A Script's type is its own: the fields of every Script and those that it declares.
void Parser::finish_script(Open& open) {
  std::vector<FieldSpec> specs(open.type->fields.begin(), open.type->fields.end());
  specs.insert(specs.end(), open.own_fields.begin(), open.own_fields.end());
  NodeType& type = reading_.document.own_types.emplace_back(*open.type);
  type.fields = arena_.copy(std::span<const FieldSpec>(specs));
  for (std::size_t i = open.first_field; i < fields_.size(); ++i)
    fields_[i].spec = find_field(type, fields_[i].spec->name);
  open.type = &type;
  if (open.definition != nullptr) open.definition->type = &type;
}

const FieldSpec* Parser::find_field_of(const Open& open, std::string_view name) const {
  const FieldSpec* field = find_field(*open.type, name);
  if (field != nullptr) return field->access == Access::kContent ? nullptr : field;
  const auto it = std::ranges::find(open.own_fields, name, &FieldSpec::name);
  return it == open.own_fields.end() ? nullptr : &*it;
}

bool Parser::is_field_of_open_node(std::string_view word) const {
  if (open_ == nullptr) return find_access(word).has_value();  // in an interface
  return find_field_of(*open_, word) != nullptr ||
         (open_->type->meaning == Meaning::kScript && find_access(word).has_value());
}

void Parser::parse_fields(Open& open) {
  const Token brace = tokens_.take();
  const auto type = [&] { return std::string(open.type->name); };
  while (true) {
    switch (tokens_.peek().kind) {
      case kCloseBrace:
        tokens_.take();
        return;
      case kWord:
        if (open.type->meaning == Meaning::kScript && find_access(tokens_.peek().text)) {
          parse_script_declaration(open);
        } else if (!parse_statement()) {
          parse_field(open);
        }
        break;
      case kEnd:
        open.damaged = true;
        tokens_.report_unclosed(tokens_.position_of(brace), type(), '}');
        return;
      case kCloseBracket:
        open.damaged = true;
        tokens_.error(tokens_.position(), "expected a field of " + type() + " or its '}', found ']'");
        if (values_.in_list()) return;
        tokens_.take();
        break;
      default:
        open.damaged = true;
        tokens_.error(tokens_.position(), "expected a field of " + type() + ", found " + described(tokens_.peek()));
        while (tokens_.at(kNumber) || tokens_.at(kString) || tokens_.at(kPeriod)) tokens_.take();
        if (tokens_.at(kOpenBrace) || tokens_.at(kOpenBracket)) skip_balanced();
    }
  }
}

void Parser::parse_field(Open& open) {
  const Token name = tokens_.take();
  const FieldSpec* spec = find_field_of(open, name.text);
  Access access = spec != nullptr ? spec->access : Access::kField;
  if (spec == nullptr) {
    // An exposedField x has the events set_x and x_changed (4.7).
    const bool in = name.text.starts_with("set_");
    const std::string_view base = in                                ? name.text.substr(4)
                                  : name.text.ends_with("_changed") ? name.text.substr(0, name.text.size() - 8)
                                                                    : std::string_view{};
    spec = find_field_of(open, base);
    if (spec == nullptr || spec->access != Access::kExposedField) return parse_unknown_field(open, name);
    access = in ? Access::kEventIn : Access::kEventOut;
  }
  if (tokens_.at_word("IS")) return parse_is(open, *spec, access, tokens_.position_of(name));
  if (!has_value(access)) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name), quoted(name.text) + " is an " + std::string(name_of(access)) + " of " +
                                                 std::string(open.type->name) + ": a file cannot give it a value");
    return skip_value();
  }
  const auto same = [&](const Field& f) { return f.spec == spec; };
  if (std::ranges::any_of(open.links, [&](const PendingLink& link) { return link.inner == spec; })) {
    tokens_.warning(tokens_.position_of(name), quoted(name.text) + " is given twice; the last IS counts");
  }
  if (std::any_of(fields_.begin() + static_cast<std::ptrdiff_t>(open.first_field), fields_.end(), same)) {
    tokens_.warning(tokens_.position_of(name), quoted(name.text) + " is given twice; the last one counts");
    fields_.erase(std::remove_if(fields_.begin() + static_cast<std::ptrdiff_t>(open.first_field), fields_.end(), same),
                  fields_.end());
  }
  const std::uint32_t before = tokens_.peek().offset;
  if (const std::optional<Field> value = values_.read(*spec)) {
    fields_.push_back(*value);
  } else {
    open.damaged = true;
    // What is there instead is part of the same mistake; a word may be the next field.
    if (tokens_.peek().offset == before && (tokens_.at(kString) || tokens_.at(kNumber))) skip_value();
  }
}

// FIELD IS NAME: table 4.4 of the standard says what may be which.
void Parser::parse_is(Open& open, const FieldSpec& spec, Access access, Position at) {
  const Position is_at = tokens_.position();
  tokens_.take();
  if (!tokens_.at(kWord)) {
    open.damaged = true;
    return tokens_.error(tokens_.position(),
                         "expected a name of the PROTO's interface after IS, found " + described(tokens_.peek()));
  }
  const Token name = tokens_.take();
  const auto refuse = [&](Position where, const std::string& why) {
    open.damaged = true;
    tokens_.error(where, why);
  };
  Prototype* const prototype = scope_->prototype;
  if (prototype == nullptr) return refuse(is_at, "IS belongs inside a PROTO");
  const FieldSpec* outer = find_field(prototype->type, name.text);
  if (outer == nullptr) {
    Suggestion suggestion(name.text);
    for (const FieldSpec& field : prototype->type.fields) suggestion.consider(field.name);
    return refuse(tokens_.position_of(name), "the interface of " + quoted(prototype->type.name) + " has no " +
                                                 quoted(name.text) + did_you_mean(suggestion));
  }
  if (outer->type != spec.type) {
    return refuse(at, quoted(spec.name) + " is " + std::string(name_of(spec.type)) + " and cannot be " +
                          quoted(outer->name) + ", which is " + std::string(name_of(outer->type)));
  }
  const bool value = outer->access == Access::kExposedField && access == Access::kField;
  if (value) {
    tokens_.warning(at, "the field " + quoted(spec.name) + " takes the value of the exposedField " +
                            quoted(outer->name) + ", and no events: the standard wants a field here");
  } else if (outer->access != access && access != Access::kExposedField) {
    return refuse(at, "the " + std::string(name_of(access)) + ' ' + quoted(spec.name) + " cannot be the " +
                          std::string(name_of(outer->access)) + ' ' + quoted(outer->name));
  }
  const auto same = [&](const auto& other) { return other.inner == &spec && has_value(access); };
  const auto given = [&](const Field& f) { return f.spec == &spec; };
  if (std::ranges::any_of(open.links, same) ||
      std::any_of(fields_.begin() + static_cast<std::ptrdiff_t>(open.first_field), fields_.end(), given)) {
    tokens_.warning(at, quoted(spec.name) + " is given twice; the last IS counts");
  }
  open.links.push_back({outer, &spec, at});
}

void Parser::parse_script_declaration(Open& open) {
  const Token keyword = tokens_.take();
  const Access access = *find_access(keyword.text);
  const auto type = tokens_.at(kWord) ? find_field_type(tokens_.peek().text) : std::nullopt;
  if (!type) {
    open.damaged = true;
    tokens_.error(tokens_.position(), "expected a field type, found " + described(tokens_.peek()));
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    return skip_value();
  }
  tokens_.take();
  if (!tokens_.at(kWord) || is_keyword(tokens_.peek().text)) {
    open.damaged = true;
    tokens_.error(tokens_.position(), "expected the name of a field, found " + described(tokens_.peek()));
    if (tokens_.at(kWord) && !find_access(tokens_.peek().text)) tokens_.take();
    return has_value(access) ? skip_value() : void();
  }
  const Token name = tokens_.take();
  if (access == Access::kExposedField) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(keyword), "a Script declares fields, eventIns and eventOuts, no exposedFields");
  }
  if (find_field_of(open, name.text) != nullptr) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name), "this Script has " + quoted(name.text) + " already");
  }
  if (open.own_fields.size() >= kMaxFields) {
    if (!std::exchange(open.damaged, true)) too_many(tokens_.position_of(name));
    return has_value(access) ? skip_value() : void();
  }
  const FieldSpec& spec =
      open.own_fields.emplace_back(FieldSpec{arena_.copy(name.text), *type, access, {}, Range::kAny, kAnyClass});
  if (tokens_.at_word("IS")) return parse_is(open, spec, access, tokens_.position_of(name));
  if (!has_value(access)) return;
  // Scripts in this field's nodes have lists of their own.
  std::vector<Definition*> outer_uses = std::exchange(script_uses_, {});
  if (const std::optional<Field> value = values_.read(spec)) {
    fields_.push_back(*value);
    auto around = script_uses_.begin();
    for (const NodeRef& ref : value->as<NodeRef>().first(script_uses_.empty() ? 0 : value->count)) {
      // The document's arena is ours to write until it is handed over.
      if (ref.index == kAround) scope_->waiting.emplace_back(*around++, const_cast<NodeRef*>(&ref));
    }
  } else {
    open.damaged = true;
  }
  script_uses_ = std::move(outer_uses);
}

void Parser::parse_unknown_field(Open& open, const Token& name) {
  const std::string type(open.type->name);
  if (tokens_.at(kOpenBrace) && find_type(name).type != nullptr) {
    open.damaged = true;
    tokens_.error(tokens_.position_of(name),
                  quoted(name.text) + " is a node; the name of a field of " + type + " is missing before it");
    parse_node_body({}, name, tokens_.position_of(name));
    return;
  }
  Suggestion suggestion(name.text);
  for (const FieldSpec& field : open.type->fields) {
    if (field.access != Access::kContent) suggestion.consider(field.name);
  }
  for (const FieldSpec& field : open.own_fields) suggestion.consider(field.name);
  if (open.type->meaning == Meaning::kDisplay && !suggestion.best()) {
    // A browser's own addition, as many have: passed over whole, not read.
    tokens_.warning(tokens_.position_of(name),
                    type + " has no field " + quoted(name.text) + " in VRML97; it is passed over");
    while (tokens_.at_word("DEF") || tokens_.at_word("USE") || tokens_.kind_after() == kOpenBrace) {
      const bool def = tokens_.take().text == "DEF";
      if (def && tokens_.at(kWord)) lose(tokens_.take().text);
    }
    if (tokens_.at(kOpenBrace)) return skip_balanced();
    return skip_value();
  }
  open.damaged = true;
  tokens_.error(tokens_.position_of(name), type + " has no field " + quoted(name.text) + did_you_mean(suggestion));
  if (tokens_.at_word("IS")) {
    tokens_.take();
    if (tokens_.at(kWord)) tokens_.take();
    return;
  }
  skip_value();
}

}  // namespace

namespace {

// 4.10.2: repeated ROUTEs are ignored; those of an interface may coincide.
void drop_repeated(std::vector<Route>& routes) {
  std::set<std::tuple<std::uint32_t, const FieldSpec*, std::uint32_t, const FieldSpec*>> seen;
  std::erase_if(routes, [&](const Route& r) { return !seen.emplace(r.from_node, r.from, r.to_node, r.to).second; });
}

}  // namespace

std::shared_ptr<Document> parse(Source world, Problems& problems, const ParseOptions& options) {
  auto document = std::make_shared<Document>();
  Reading reading{.document = *document, .problems = problems, .options = options};
  const std::string name = world.name;
  if (const auto text = open_text(reading, std::move(world))) {
    reading.open_files.push_back(name);
    reading.world.nodes.reserve(guess_nodes(problems.text_of(text->begin), options.limits));
    Parser(reading, text->begin, text->body, 0).parse_text(reading.world);
    document->nodes = std::move(reading.world.nodes);
    document->top_level = std::move(reading.world.roots);
    document->routes = std::move(reading.world.routes);
    document->inner_names = std::move(reading.world.inner_names);
    drop_repeated(document->routes);
  } else {
    problems.error(0, text.error());
  }
  return document;
}

}  // namespace peerd::vrml
