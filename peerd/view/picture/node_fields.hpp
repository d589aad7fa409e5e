#pragma once
#include <Eigen/Core>
#include <span>
#include <string_view>

#include "core/vrml/default_values.hpp"
#include "core/vrml/document.hpp"

namespace peerd::view {

// These functions read fields of nodes, given or by default. A node that an EXTERNPROTO stands for has none of them.

template <class T>
[[nodiscard]] std::span<const T> values(const vrml::Node& node, std::string_view field) {
  return vrml::value_of(node, field).as<T>();
}
template <class T>
[[nodiscard]] T value(const vrml::Node& node, std::string_view field) {
  return values<T>(node, field)[0];
}
[[nodiscard]] inline Eigen::Vector3f vector_of(const vrml::Node& node, std::string_view field) {
  const auto v = values<float>(node, field);
  return {v[0], v[1], v[2]};
}

// The node of any type that a field has; null where it has none.
[[nodiscard]] inline const vrml::Node* node_in(const vrml::Document& document, const vrml::Node& node,
                                               std::string_view field) {
  const vrml::Field* const given = node.find(field);
  if (given == nullptr || given->count == 0) return nullptr;
  const vrml::NodeRef ref = given->as<vrml::NodeRef>()[0];
  return ref.is_node() ? &document.nodes[ref.index] : nullptr;
}
// The node of one type.
[[nodiscard]] inline const vrml::Node* node_in(const vrml::Document& document, const vrml::Node& node,
                                               std::string_view field, std::string_view type) {
  const vrml::Node* const found = node_in(document, node, field);
  return found != nullptr && found->type->name == type && !found->damaged ? found : nullptr;
}

}  // namespace peerd::view
