#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Nodes that refer to each other by their places: a world's, an inlined file's or those of a PROTO's body.
struct Body {
  std::vector<Node> nodes;  // a node stands behind all that it refers to
  std::vector<NodeRef> roots;
  std::vector<Route> routes;
  std::vector<InnerName> inner_names;
  std::uint32_t scopes = 1;      // Node::scope is below it
  std::uint64_t references = 0;  // in the fields of `nodes`
};

// `node`'s field `inner` IS the field `outer` of the interface.
struct IsLink {
  const FieldSpec* outer = nullptr;
  std::uint32_t node = NodeRef::kNull;
  const FieldSpec* inner = nullptr;
  Position at = 0;
};

// A PROTO, or an EXTERNPROTO that was found or will not be (4.8, 4.9).
struct Prototype {
  NodeType type;                               // its interface as fields
  std::vector<std::optional<Field>> defaults;  // of each of type.fields; none for events and what could not be read
  Body body;                  // its default nodes and its own; what it is made of stands expanded in it
  std::vector<IsLink> links;  // to fields and events of `body`, through what is expanded in it
  // Set for an EXTERNPROTO that no file defines: its instances are nodes of that type, with its interface and no more.
  const NodeType* not_found = nullptr;
};

// Puts a copy of the prototype's body behind `out`, with the fields `given` where they IS: checks their nodes' classes
// and their ranges there. Gives the place of the copy's first node, or kNull where the prototype has none.
struct Expansion {
  std::uint32_t root = NodeRef::kNull;
  std::uint32_t base = 0;  // node i of prototype.body is node base + i of `out`
};
[[nodiscard]] Expansion expand(const Prototype& prototype, std::span<const Field> given, Body& out, Arena& arena,
                               Problems& problems);

// A node and all that it refers to, in the order of their body, itself last.
struct NodeSet {
  std::vector<std::uint32_t> nodes;
  std::uint64_t references = 0;  // in their fields
};
[[nodiscard]] NodeSet reach(const Body& body, std::uint32_t node);
// Puts a copy of them from one body into another; gives the place of the last.
[[nodiscard]] std::uint32_t copy_nodes(const Body& from, const NodeSet& nodes, Body& to, Arena& arena);

// Whether `field` may hold those values and nodes of `nodes`; reports what it may not.
bool check_nodes(const FieldSpec& spec, const Field& value, const std::vector<Node>& nodes, Problems& problems);
bool check_range(const FieldSpec& spec, const Field& value, Problems& problems);

}  // namespace peerd::vrml
