#pragma once
#include <list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parser/parse_context.hpp"
#include "core/vrml/token_stream.hpp"
#include "core/vrml/value_reader.hpp"

namespace peerd::vrml {

// One text of a world to nodes; other texts that it names are read by parsers of their own on the way. Its functions
// stand in files by what they read: text_parser.cpp nodes, _fields fields and Scripts, _prototypes PROTO and
// EXTERNPROTO, _routes ROUTE, _files Inlines and what is behind URLs.
class TextParser {
 public:
  TextParser(ParseContext& context, Position text_begin, std::size_t begin, std::uint32_t nesting)
      : context_(context),
        arena_(context.document.arena),
        problems_(context.problems),
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
  struct OpenNode {
    const NodeType* type = nullptr;
    OpenNode* outer = nullptr;
    std::size_t first_field = 0;  // of it in fields_
    std::vector<PendingLink> links{};
    std::vector<const FieldSpec*>
        linked{};                       // fields whose value comes by a link, each once: few, where links can be many
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
  std::optional<std::pair<FieldType, Token>> parse_type_and_name();
  std::optional<Field> parse_default(const FieldSpec& spec, Prototype& prototype);
  void parse_body_of(Prototype& prototype, std::string_view name);
  void add_native(Declaration& declaration, std::string_view name);
  bool fits(std::span<const FieldSpec> interface, const NodeType& type, Position at);
  Type find_type(const Token& name);
  void resolve(Declaration& declaration, std::string_view name);
  const Declaration* find_in_library(std::string_view url, Position at, std::string& why);
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
    // The nodes base + link.node of the scope's body, and their fields; of an instance as many as it has links.
    [[nodiscard]] std::span<const IsLink> links() const { return inner ? *inner : std::span<const IsLink>(&own, 1); }
    std::uint32_t base = 0;
    IsLink own{};
    std::optional<std::span<const IsLink>> inner{};
  };
  Event find_event(const RouteEnd& end, bool sends);
  void add_routes(const Scope& scope, const RouteEnd& from, const RouteEnd& to);

  std::optional<NodeRef> parse_node_value(const FieldSpec& spec);
  NodeRef parse_node();
  NodeRef parse_use();
  NodeRef parse_node_body(const Token& def, const Token& type_name, Position at);
  NodeRef close_node(OpenNode& open, const Token& def, Position at);
  NodeRef close_instance(OpenNode& open, const Prototype& prototype, const Token& def, Position at);
  void finish_script(OpenNode& open);
  void parse_fields(OpenNode& open);
  void parse_field(OpenNode& open);
  void parse_is(OpenNode& open, const FieldSpec& spec, Access access, Position at);
  void parse_script_declaration(OpenNode& open);
  void parse_unknown_field(OpenNode& open, const Token& name);
  void report_unknown_type(const Token& name);
  bool is_field_of_open_node(std::string_view word) const;
  const FieldSpec* find_field_of(const OpenNode& open, std::string_view name) const;
  void skip_value() {
    // Nodes in there are none of the Script field in hand.
    std::vector<Definition*> outer_uses = std::exchange(script_uses_, {});
    define_unreadable(values_.skip());
    script_uses_ = std::move(outer_uses);
  }
  void skip_balanced() { define_unreadable(tokens_.skip_balanced()); }
  void define_unreadable(const std::vector<std::string_view>& names) {
    for (const std::string_view name : names) define_unreadable(name);
  }
  void define_unreadable(std::string_view name) {
    if (!name.empty()) define(name);
  }
  Definition& define(std::string_view name);
  [[nodiscard]] bool in_world_body() const { return scope_->body == &context_.world; }

  void load_inlines_of(const Prototype& prototype, std::span<const Field> given);
  [[nodiscard]] bool is_deferred(Position inline_at, const Field* box_size) const;
  void fill_inline(Node& node);
  const std::vector<NodeRef>* load_content(const Field& url);
  ParseContext::File* open_file(std::string_view url, Position at, std::string& why);
  bool is_open(std::string_view name) const;

  ParseContext& context_;
  Arena& arena_;
  Problems& problems_;
  TokenStream tokens_;
  ValueReader values_;
  Scope* scope_ = nullptr;
  OpenNode* open_ = nullptr;                  // the innermost open node
  std::vector<Field> fields_;             // of all open nodes
  std::vector<Definition*> script_uses_;  // open ones that the Script field in hand names, in order
  std::uint32_t nesting_;                 // of nodes and PROTOs, through files: each is a recursion
};

}  // namespace peerd::vrml
