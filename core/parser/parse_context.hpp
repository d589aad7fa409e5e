#pragma once
#include <deque>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/vrml/document.hpp"
#include "core/vrml/lexer.hpp"
#include "core/vrml/name_table.hpp"
#include "core/vrml/other_reader.hpp"
#include "core/vrml/parse_options.hpp"
#include "core/vrml/prototype.hpp"
#include "core/x3d/classic_text.hpp"

namespace peerd::vrml {

inline constexpr std::size_t kMaxOpenFiles = 32;  // an Inline in an Inline in ..; each is a recursion
inline constexpr std::uint32_t kOpenNode =
    NodeRef::kNull - 1;                             // a node that is still open, until its closing brace is read
inline constexpr std::size_t kMaxFields = 4096;     // most fields of a PROTO or a Script, which are searched one by one
inline constexpr std::uint32_t kMaxResolving = 64;  // EXTERNPROTOs that lead to one another; each is a recursion
inline constexpr std::string_view kExtensionUrn = "urn:peerd:node:";

// The nodes of appendix C of the thesis that a world may also declare, so that other browsers load it.
inline constexpr std::string_view kExtensionNodes[] = {"CollisionInterest", "CollisionResponse", "KeySensor"};

// A Definition is the node that a DEF names, known from its '{' on.
struct Definition {
  const NodeType* type = nullptr;        // the fields that ROUTEs and the author see; null where the node was lost
  const Prototype* prototype = nullptr;  // the PROTO that the node is an instance of; the copy begins at `base`
  std::uint32_t node = NodeRef::kNull;   // kNull while it is open, and where an error made it unreadable
  std::uint32_t base = 0;
  bool open = false;
  bool loss_reported = false;  // that something refers to the node, which was left out
};

// A PROTO by the name that it has in a scope; an EXTERNPROTO is looked for when it is used first.
struct Declaration {
  const Prototype* prototype = nullptr;
  const NodeType* native = nullptr;  // one of our own nodes stands for it
  bool external = false;
  bool resolving = false;  // the search for it is under way
  std::span<const FieldSpec> interface {};
  std::span<const std::string_view> urls{};
  Position at = 0;
};
using Declarations = std::unordered_map<std::string_view, Declaration>;

struct RouteEnd {
  Definition* node = nullptr;
  std::string_view name, event;
  Position at = 0;
};

// A Scope is a part of a text in which names hold: a file, the body of a PROTO, a default value in its interface.
// PROTOs are seen from within, DEFs are not (4.4.3, 4.8.1).
struct Scope {
  Scope* outer = nullptr;
  Body* body = nullptr;
  Prototype* prototype = nullptr;  // the PROTO that this is the body of; IS refers to it
  std::uint32_t id = 0;            // Node::scope
  std::deque<Definition> definitions{};
  LateNameTable<Definition*> names{};
  std::unordered_map<const Definition*, std::vector<NodeRef*>>
      unresolved_refs{};  // Scripts' fields that refer to open ones
  Declarations declarations{};
  std::vector<std::pair<RouteEnd, RouteEnd>> routes{};
};

// A text that was taken among the sources.
struct OpenText {
  Position begin = 0;
  std::size_t body = 0;  // offset behind its header
  Dialect dialect = Dialect::kVrml97;
  std::shared_ptr<const ClassicText> classic{};  // is read in its place, where it is X3D in XML
};

// All texts of a world share one ParseContext.
struct ParseContext {
  Document& document;
  Problems& problems;
  const ParseOptions& options;
  // Reads a whole text into a body and returns the PROTOs of its top level. The parser of one text calls this for the
  // others that the text names; `nesting` is how many nodes, PROTOs and files are open around it.
  std::function<Declarations(const OpenText& text, std::uint32_t nesting, Body& body)> parse_text;
  OtherReader read_other{};  // may be empty
  Body world{};
  std::deque<Prototype> prototypes{};
  struct File {
    OpenText text{};
    bool readable = false;
    std::shared_ptr<const Document> other{};        // its nodes, where it is of another format: it has no PROTOs
    std::string why{};                              // the reason if it is not readable
    std::optional<std::vector<NodeRef>> content{};  // roots in `world`, once read as an Inline
    std::optional<Declarations> library{};          // PROTOs, once read for an EXTERNPROTO
    std::map<std::string_view, Definition, std::less<>> exports{};  // nodes of `content`, by the names of its EXPORTs
  };
  std::map<std::string, File, std::less<>> files{};  // indexed by LoadedFile::name
  std::vector<std::string_view> open_files{};
  std::uint64_t text_bytes = 0;
  std::uint64_t node_eighths = 0;  // eighths of nodes in all bodies
  std::uint32_t resolving = 0;     // EXTERNPROTOs that lead to one another
  bool too_many_nodes = false;
  bool has_x3d = false;                                      // one of the texts is X3D
  std::unordered_map<std::uint32_t, const File*> inlined{};  // files of X3D, by the nodes of their Inlines in `world`
  // Fields that PROTOs and Scripts declare with types that only X3D has: they are reported there, and are not kept.
  std::set<std::pair<const NodeType*, std::string_view>> unkept_fields{};

  // References and ROUTEs are smaller than nodes, and can be more: eight of them count as a node.
  [[nodiscard]] bool room_for(std::uint64_t nodes, std::uint64_t references, Position at) {
    const std::uint64_t eighths = 8 * nodes + references;
    if (node_eighths + eighths <= 8 * std::uint64_t{options.limits.nodes}) {
      node_eighths += eighths;
      return true;
    }
    if (!std::exchange(too_many_nodes, true)) {
      problems.error(
          at, "with this node there are more than " + std::to_string(options.limits.nodes) + " nodes, PROTOs expanded");
    }
    return false;
  }
};

// Why a text is not taken; where it is a fault, a lenient reader takes it.
struct UnopenedText {
  std::string why;
  bool is_fault = false;
};
// Unpacks a text, checks its header and takes it among the sources.
[[nodiscard]] std::expected<OpenText, UnopenedText> open_text(ParseContext& context, Source source);

}  // namespace peerd::vrml
