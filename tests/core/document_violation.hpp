#pragma once
#include <algorithm>
#include <string>

#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Returns the promise of document.hpp that the document breaks; an empty string where it keeps all.
inline std::string document_violation(const Document& document) {
  const auto owns = [](const NodeType& type, const FieldSpec* spec) {
    return std::ranges::any_of(type.fields, [&](const FieldSpec& field) { return &field == spec; });
  };
  for (std::size_t i = 0; i < document.nodes.size(); ++i) {
    const Node& node = document.nodes[i];
    const std::string place = "node " + std::to_string(i);
    const auto same = [&](const NodeType& type) { return &type == node.type; };
    const auto of_source = [&](const auto& source) { return std::ranges::any_of(source->own_types, same); };
    if (!std::ranges::any_of(node_types(), same) && !std::ranges::any_of(document.own_types, same) &&
        !std::ranges::any_of(document.sources, of_source)) {
      return place + " has a type that is neither the table's nor the document's";
    }
    for (const Field& field : node.given()) {
      if (!owns(*node.type, field.spec)) return place + " has a field that is not its type's";
      if (field.spec->type != FieldType::kSFNode && field.spec->type != FieldType::kMFNode) continue;
      // The fields that a Script declares itself may name nodes around it.
      const bool own =
          node.type->name == "Script" && find_field(*find_node_type("Script"), field.spec->name) == nullptr;
      for (const NodeRef& ref : field.as<NodeRef>()) {
        if (ref.is_node() && ref.index >= document.nodes.size()) return place + " refers to a node that is none";
        if (ref.is_node() && ref.index >= i && !own) return place + " stands before a node that it refers to";
      }
    }
  }
  for (const NodeRef& ref : document.top_level) {
    if (ref.is_node() && ref.index >= document.nodes.size()) return "a top-level node is no node";
  }
  for (const Route& route : document.routes) {
    if (route.from_node >= document.nodes.size() || route.to_node >= document.nodes.size())
      return "a ROUTE's end is no node";
    if (!owns(*document.nodes[route.from_node].type, route.from)) return "a ROUTE comes from a field of another type";
    if (!owns(*document.nodes[route.to_node].type, route.to)) return "a ROUTE goes to a field of another type";
    if (route.from->type != route.to->type) return "a ROUTE joins two field types";
    if (!sends_events(route.from->access) || !takes_events(route.to->access)) return "a ROUTE's end has no events";
  }
  return {};
}

}  // namespace peerd::vrml
