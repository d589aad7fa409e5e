#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// A DocumentEditor makes a document of another one and of changes to it: one that a reader might have read, so that
// nothing that takes documents knows of edits. Values are shared with the texts that they came with. Nodes are named by
// their index: those of the document keep theirs until finish(), those of added texts follow.
class DocumentEditor {
 public:
  explicit DocumentEditor(std::shared_ptr<const Document> document);

  // Adds the nodes of a text, whose names are seen from within it alone. Returns the index of its first node; the
  // others follow in order. Its top-level nodes stand nowhere yet.
  std::uint32_t append(std::shared_ptr<const Document> text, NodeId first);

  [[nodiscard]] const Node& node(std::uint32_t index) const { return nodes_[index]; }
  [[nodiscard]] std::uint32_t node_count() const { return static_cast<std::uint32_t>(nodes_.size()); }
  [[nodiscard]] NodeId id_of(std::uint32_t node) const { return ids_[node]; }
  // The nodes at the top level, and those in the node field of a node, to be changed.
  [[nodiscard]] std::vector<NodeRef>& top_level() { return top_level_; }
  [[nodiscard]] std::vector<NodeRef>& list(std::uint32_t node, const FieldSpec& field);
  // Sets a field to a copy of the value.
  void set(std::uint32_t node, const Field& value);
  [[nodiscard]] std::vector<Route>& routes() { return routes_; }
  // Takes nodes out of all lists that they stand in; in ascending order.
  void drop(std::span<const std::uint32_t> nodes);

  // Returns for each node whether anything leads to it, as it must to be in the document.
  [[nodiscard]] std::vector<bool> reached();

  // The nodes that a node leads to, itself included, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> below(std::uint32_t node) const;

  // Returns the document, to be completed by set_strings(), and where each node is in it; NodeRef::kNull: nothing leads
  // to the node any more. The editor is not used any more.
  struct Result {
    std::shared_ptr<Document> document;
    std::vector<std::uint32_t> place;
  };
  [[nodiscard]] Result finish();

 private:
  [[nodiscard]] std::vector<Field> fields_of(std::uint32_t node) const;
  void mark_outside(std::uint32_t begin, std::span<const NodeRef> top_level);
  void visit(std::uint32_t node);
  void visit_all();
  void write(std::uint32_t node);
  [[nodiscard]] std::span<const NodeRef> refs_of(std::uint32_t node, const Field& field) const;

  std::vector<std::shared_ptr<const Document>> sources_;
  std::vector<Node> nodes_;
  std::vector<NodeId> ids_;
  std::vector<NodeRef> top_level_;
  std::vector<Route> routes_;
  std::vector<InnerName> inner_names_;
  std::vector<bool> is_outside_;  // by node: none of the scene leads to it, such as to what stands beside it in a PROTO
  std::uint32_t scopes_ = 0;
  std::map<std::pair<std::uint32_t, const FieldSpec*>, std::vector<NodeRef>> lists_;
  std::map<std::pair<std::uint32_t, const FieldSpec*>, Field> set_;
  Arena values_;  // of what is set

  std::shared_ptr<Document> result_;
  std::vector<std::uint32_t> place_;
  std::vector<std::uint32_t> order_;  // nodes of the result, each behind all that it refers to
};

// Sets a field of strings of a document that nobody reads yet.
void set_strings(Document& document, std::uint32_t node, std::string_view field, std::span<const std::string> values);

}  // namespace peerd::vrml
