#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"
#include "core/writer/path_rewriter.hpp"
#include "core/writer/write_options.hpp"

namespace peerd::vrml {

// The name of the field of the Script that holds nodes which must not be seen; it tells this Script from others.
inline constexpr std::string_view kHolderField = "outsideTheScene";

[[nodiscard]] bool is_filled_inline(const Node& node);

// OutsideNodes are the nodes that nothing at the top level holds, and that matter nevertheless: they are named, have a
// ROUTE, or do something by themselves. Only the topmost are listed, those of Inlines last, otherwise in the order of
// the document.
struct OutsideNodes {
  std::vector<std::uint32_t> plain;  // nobody sees or hears them: they may stand at the top level
  std::vector<std::uint32_t> held;
  std::size_t plain_own = 0, held_own = 0;  // the first of each that are of no Inline
};
[[nodiscard]] OutsideNodes outside_nodes(const Document& document, const PathRewriter& paths);

// The type of the node that is written in the place of a null among nodes, and of a CollisionInterest that names
// nothing. It is no instance, and the children behind it keep their numbers.
inline constexpr std::string_view kPlaceholderType = "WorldInfo";

// A WrittenField is one field as it is written. Without a value, it is an event or a field that a Script does not give.
struct WrittenField {
  const FieldSpec* spec = nullptr;
  const Field* value = nullptr;
  std::string_view name;
  bool declared = false;  // a Script's own: written with its access and type
};

// A WritePlan says which nodes are written, in which order and under which names. It is made in one walk in the order
// of the text; the writer takes the same walk again.
class WritePlan {
 public:
  WritePlan(const Scene& scene, const WriteOptions& options);

  [[nodiscard]] std::string_view name_of(std::uint32_t node) const { return names_[node]; }  // empty: no DEF
  [[nodiscard]] std::string_view type_name_of(const Node& node) const;
  [[nodiscard]] std::vector<WrittenField> fields_of(const Node& node) const;
  [[nodiscard]] const OutsideNodes& outside() const { return outside_; }
  [[nodiscard]] const std::vector<const NodeType*>& external_types() const { return external_types_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] bool too_deep() const { return too_deep_; }

  // The action that a walk takes at a reference, `holder` being the node that has it (kNull: the top level).
  enum class RefAction : std::uint8_t { kNull, kPlaceholder, kDefine, kUse, kLater };
  [[nodiscard]] RefAction action_at(const NodeRef& ref, std::uint32_t holder, std::vector<bool>& visited) const;

  // The first function returns the ROUTEs to write where the walk is the i-th time at a place for them (before the '}'
  // of a node that holds nodes, and behind each node at the top level); the second returns all others, which stand at
  // the end.
  [[nodiscard]] std::span<const std::uint32_t> routes_at(std::uint32_t place) const;
  [[nodiscard]] const std::vector<std::uint32_t>& last_routes() const { return last_routes_; }

  // Returns the path under which the written world knows the instance that `path` of that node names; nothing where it
  // names nothing.
  [[nodiscard]] std::optional<std::string> path_for(const Node& node, std::string_view path) const {
    return paths_.rewritten(path, node.scope);
  }

 private:
  void visit_top_level();
  void visit(std::uint32_t node, std::uint32_t depth);
  void visit_item(const NodeRef& ref, std::uint32_t holder, std::uint32_t depth);
  void end_place() { places_.push_back(++time_); }
  void plan_routes();
  void choose_names();
  [[nodiscard]] std::string_view unused_name(std::string_view base, std::uint32_t first);
  [[nodiscard]] std::string_view lawful_name(std::string_view name);
  void rename(std::uint32_t node, const std::string& why);
  void name_external_types();

  const Scene& scene_;
  const Document& document_;
  WriteOptions options_;
  PathRewriter paths_;
  OutsideNodes outside_;

  // The following members belong to the walk. Times count DEFs, USEs and places for ROUTEs.
  std::uint32_t time_ = 0;
  std::vector<bool> visited_;
  std::vector<std::uint32_t> order_;             // nodes in the order of their first place
  std::vector<std::uint32_t> defined_, needed_;  // indexed by node: when, and until when; 0: never
  std::vector<std::uint32_t> places_;            // times at which ROUTEs may stand
  bool too_deep_ = false;

  struct PlannedRoute {
    std::uint32_t route = 0, place = 0;  // the first place behind both nodes
  };
  std::vector<PlannedRoute> routes_;
  std::vector<std::uint32_t> early_routes_, early_begin_, last_routes_;

  std::vector<std::string_view> names_;
  std::unordered_set<std::string_view> used_names_;
  std::unordered_map<std::string_view, std::uint32_t> counters_;
  std::deque<std::string> made_names_;
  std::vector<const NodeType*> external_types_;
  std::unordered_map<const NodeType*, std::string_view> external_names_;
  std::vector<std::string> notes_;
};

}  // namespace peerd::vrml
