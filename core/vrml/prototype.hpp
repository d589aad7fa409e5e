#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// A Body holds nodes that refer to each other by their places: those of a world, of an inlined file or of the body of a
// PROTO.
struct Body {
  std::vector<Node> nodes;  // a node stands behind all that it refers to
  std::vector<NodeRef> roots;
  std::vector<Route> routes;
  std::vector<InnerName> inner_names;
  std::uint32_t scopes = 1;      // Node::scope is below it
  std::uint64_t references = 0;  // in the fields of `nodes`
};

// An IsLink says that the field `inner` of `node` IS the field `outer` of the interface.
struct IsLink {
  const FieldSpec* outer = nullptr;
  std::uint32_t node = NodeRef::kNull;
  const FieldSpec* inner = nullptr;
  Position at = 0;
};

// A ValueLink is a link that carries a value, as expand() takes it.
struct ValueLink {
  static constexpr std::uint32_t kNone = ~0u;
  std::uint32_t node = 0;
  std::uint32_t value = 0;  // place in Prototype::linked_fields of the field whose value it takes
  const FieldSpec* inner = nullptr;
  std::uint32_t field = 0;         // numbers the linked fields of its node, as they come; links of one field share it
  std::uint32_t replaces = kNone;  // only in the first of these: the place of the node's own value of that field
};

// A Prototype is a PROTO, or an EXTERNPROTO that was found or will not be (4.8, 4.9).
struct Prototype {
  NodeType type;  // its interface as fields
  std::vector<std::optional<Field>>
      defaults;               // indexed by type.fields; none for events and values that could not be read
  Body body;                  // nodes of default values and of the body, with inner PROTOs expanded
  std::vector<IsLink> links;  // to fields and events of `body`, through what is expanded in it
  // The following lists are made of the links once all are there, so that no instance and no ROUTE reads more of them
  // than it needs: see sort_links(). The links of one `outer`, or of one node, keep their order.
  std::vector<IsLink> event_links;            // links to events, by `outer`
  std::vector<ValueLink> value_links;         // indexed by node
  std::vector<std::uint32_t> linked_fields;   // places in type.fields of those with value links
  std::vector<std::uint32_t> link_counts;     // number of value links, by linked_fields
  std::vector<std::uint32_t> value_of_field;  // indexed by place in type.fields: the place in linked_fields, or kNone
  std::uint64_t copied_references = 0;        // cost of a copy beside the nodes, references and ROUTEs of `body`
  // This is set for an EXTERNPROTO that no file defines: its instances are nodes of that type, with its interface and
  // no more.
  const NodeType* not_found = nullptr;
};

// Sorts `links` by `outer` and makes the lists that follow from them, when the prototype is complete.
void sort_links(Prototype& prototype);

// Returns the links of one field of the interface.
[[nodiscard]] std::span<const IsLink> links_of(const std::vector<IsLink>& by_outer, const FieldSpec& outer);
[[nodiscard]] std::span<const ValueLink> value_links_of(const Prototype& prototype, std::uint32_t node);
// Returns the values that the links take: those `given`, by place in linked_fields; null where there is the default.
[[nodiscard]] std::vector<const Field*> linked_values(const Prototype& prototype, std::span<const Field> given);

// Returns the cost of the values of the links of a copy, in references: the node lists of all that take one, and
// everything else that is read more than once.
[[nodiscard]] std::uint64_t cost_of_values(const Prototype& prototype, std::span<const Field> given);

// Returns the cost of copies of the fields of a node, in references: three of them have the size of a Field. A node
// counts as eight anyway.
[[nodiscard]] constexpr std::uint64_t cost_of_fields(std::uint64_t count) { return count <= 8 ? 0 : 3 * (count - 8); }

// Puts a copy of the body of the prototype behind `out`, with the fields `given` where they IS. Checks the classes of
// their nodes and their ranges there. Returns the place of the first node of the copy, or kNull where the prototype has
// none.
struct Expansion {
  std::uint32_t root = NodeRef::kNull;
  std::uint32_t base = 0;  // node i of prototype.body is node base + i of `out`
};
[[nodiscard]] Expansion expand(const Prototype& prototype, std::span<const Field> given, Body& out, Arena& arena,
                               Problems& problems);

// A NodeSet is a node and all that it refers to, in the order of their body, itself last.
struct NodeSet {
  std::vector<std::uint32_t> nodes;
  std::uint64_t references = 0;  // in their fields
  std::uint64_t cost = 0;        // cost of a copy beside the nodes, in references
};
[[nodiscard]] NodeSet reachable_nodes(const Body& body, std::uint32_t node);
// Puts a copy of the nodes from one body into another; returns the place of the last.
[[nodiscard]] std::uint32_t copy_nodes(const Body& from, const NodeSet& nodes, Body& to, Arena& arena);

}  // namespace peerd::vrml
