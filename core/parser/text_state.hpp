#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/parser/parse_context.hpp"
#include "core/vrml/token_stream.hpp"
#include "core/vrml/value_reader.hpp"
#include "core/x3d/extra_fields.hpp"
#include "core/x3d/head_statements.hpp"

namespace peerd::vrml {

// A TextState is one text while it is read, as all parts of its parser see it: the tokens to come, the reader of field
// values, and the scope that names are defined in.
struct TextState {
  // `open_around` is how many nodes, PROTOs and files are open around the text.
  TextState(ParseContext& parse_context, const OpenText& text, std::uint32_t open_around)
      : begin(text.begin),
        is_x3d(text.dialect != Dialect::kVrml97),
        classic(text.classic),
        context(parse_context),
        arena(parse_context.document.arena),
        problems(parse_context.problems),
        tokens(classic ? classic->text : problems.text_of(begin), begin, text.body, problems,
               classic ? &classic->map : nullptr),
        values(tokens, arena, problems),
        nesting(open_around) {}
  TextState(const TextState&) = delete;
  TextState& operator=(const TextState&) = delete;

  // Returns whether nodes that are read now become nodes of the world, rather than of a PROTO or of a library. Inlines
  // are loaded in the world only.
  [[nodiscard]] bool in_world_body() const { return scope->body == &context.world; }

  // Defines a name in the current scope. A name that is there already means the new definition from here on (4.4.3).
  Definition& define(std::string_view name);
  // Defines names of nodes that could not be read, so that a USE of them is not reported as well. Empty ones count not.
  void define_unreadable(std::string_view name);
  void define_unreadable(const std::vector<std::string_view>& names);
  // The DEF name in the current scope that is most like `name`.
  [[nodiscard]] Suggestion names_like(std::string_view name) const;

  // Returns whether a name of a node stands here.
  [[nodiscard]] bool at_name();
  // Returns whether a word or a number stands here that is not allowed as a name: a reserved word, or a digit first.
  [[nodiscard]] bool at_unlawful_name();
  // Takes such a name and reports it as a fault that begins with `expected`. The result is the name that it is read as,
  // which has a '_' in front.
  [[nodiscard]] Token take_unlawful_name(const std::string& expected);

  // Passes over the brackets or braces at the next token, and defines the names in them as unreadable.
  void skip_balanced() { define_unreadable(tokens.skip_balanced()); }
  // Reports the field at `at` as one more than kMaxFields.
  void report_too_many_fields(Position at);

  // The following functions know whether the text is X3D.
  [[nodiscard]] std::optional<Access> access_of(std::string_view word) const;
  [[nodiscard]] std::string name_of(Access access) const;
  // Returns the field of a type that a text names so.
  [[nodiscard]] const FieldSpec* field_of(const NodeType& type, std::string_view name) const;
  // Returns the field of X3D that is meant, by itself or by one of its events, where no document keeps it.
  [[nodiscard]] const ExtraField* unkept_field_of(const NodeType& type, std::string_view name) const;
  // Warns that metadata is not kept; once for each text.
  void report_metadata(Position at);
  // Warns that a USE or a ROUTE of X3D names a node that was left out; once for each node.
  void report_lost(Definition& definition, std::string_view name, Position at);
  // Leads the angles of a value from the text's unit to radians.
  void convert_angles(const NodeType& type, Field& value);

  const Position begin;  // of the text, among all texts of the world
  const bool is_x3d;
  const std::shared_ptr<const ClassicText> classic;
  ParseContext& context;
  Arena& arena;
  Problems& problems;
  TokenStream tokens;
  ValueReader values;
  Scope* scope = nullptr;
  std::uint32_t nesting = 0;  // open nodes and PROTOs, through files: each is a recursion
  FileUnits units{};
  bool metadata_reported = false;
};

// The rules of the VRML97 grammar (ISO/IEC 14772-1, annex A) that contain each other. A part of the parser that meets
// such a rule inside its own calls it through this interface, so that the parts need not know each other.
class Grammar {
 public:
  // Reads a PROTO, an EXTERNPROTO or a ROUTE if one stands here, and says whether one did.
  virtual bool parse_statement() = 0;
  // Reads a node or a USE. The result is null where it could not be read.
  virtual NodeRef parse_node() = 0;
  // Reads a node whose type name has been taken. `def` is the name behind its DEF, or an empty token; `at` is the
  // position of the first token of the node.
  virtual NodeRef parse_node_body(const Token& def, const Token& type_name, Position at) = 0;

 protected:
  ~Grammar() = default;
};

}  // namespace peerd::vrml
