#include "core/formats/draft/node_draft.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::formats {

NodeDraft::NodeDraft(vrml::Document& document, std::string_view type, vrml::Position at) : document_(document) {
  node_.type = vrml::find_node_type(type);
  node_.at = at;
  assert(node_.type != nullptr && "it is a node of the standard");
}

NodeDraft& NodeDraft::named(std::string_view def) {
  if (!def.empty()) node_.def = document_.arena.copy(def);
  return *this;
}

void NodeDraft::set(std::string_view field, const void* data, std::size_t count) {
  const vrml::FieldSpec* const spec = vrml::find_field(*node_.type, field);
  assert(spec != nullptr && "the node has the field");
  fields_.push_back({spec, data, static_cast<std::uint32_t>(count), node_.at});
}

template <class T>
NodeDraft& NodeDraft::keep(std::string_view field, std::span<const T> values) {
  set(field, document_.arena.copy(values).data(), values.size());
  return *this;
}

template <class T>
NodeDraft& NodeDraft::adopt(std::string_view field, std::vector<T>&& values) {
  const auto kept = std::make_shared<const std::vector<T>>(std::move(values));
  document_.arrays.push_back(kept);
  set(field, kept->data(), kept->size());
  return *this;
}

NodeDraft& NodeDraft::floats(std::string_view field, std::span<const float> values) { return keep(field, values); }
NodeDraft& NodeDraft::floats(std::string_view field, std::initializer_list<float> values) {
  return keep(field, std::span<const float>(values.begin(), values.size()));
}
NodeDraft& NodeDraft::floats(std::string_view field, std::vector<float>&& values) {
  return adopt(field, std::move(values));
}
NodeDraft& NodeDraft::integers(std::string_view field, std::vector<std::int32_t>&& values) {
  return adopt(field, std::move(values));
}
NodeDraft& NodeDraft::shared_integers(std::string_view field, std::span<const std::int32_t> values) {
  set(field, values.data(), values.size());
  return *this;
}
std::span<const std::int32_t> NodeDraft::last_integers() const { return fields_.back().as<std::int32_t>(); }
NodeDraft& NodeDraft::integer(std::string_view field, std::int32_t value) {
  return keep(field, std::span<const std::int32_t>(&value, 1));
}
NodeDraft& NodeDraft::flag(std::string_view field, bool value) { return keep(field, std::span<const bool>(&value, 1)); }
NodeDraft& NodeDraft::time(std::string_view field, double value) {
  return keep(field, std::span<const double>(&value, 1));
}

NodeDraft& NodeDraft::strings(std::string_view field, std::span<const std::string_view> values) {
  const auto kept = document_.arena.allocate<std::string_view>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) kept[i] = document_.arena.copy(values[i]);
  set(field, kept.data(), kept.size());
  return *this;
}
NodeDraft& NodeDraft::string(std::string_view field, std::string_view value) {
  return strings(field, std::span(&value, 1));
}

NodeDraft& NodeDraft::nodes(std::string_view field, std::span<const vrml::NodeRef> refs) { return keep(field, refs); }
NodeDraft& NodeDraft::node(std::string_view field, vrml::NodeRef ref) {
  return ref.is_node() ? nodes(field, std::span(&ref, 1)) : *this;
}

void NodeDraft::give_to(vrml::Node& node) {
  assert(node.type == node_.type);
  std::vector<vrml::Field> all(node.given().begin(), node.given().end());
  std::erase_if(all, [&](const vrml::Field& old) {
    return std::ranges::find(fields_, old.spec, &vrml::Field::spec) != fields_.end();
  });
  all.insert(all.end(), fields_.begin(), fields_.end());
  node.fields = document_.arena.copy(std::span<const vrml::Field>(all)).data();
  node.field_count = static_cast<std::uint32_t>(all.size());
}

vrml::NodeRef NodeDraft::add() {
  const auto fields = document_.arena.copy(std::span<const vrml::Field>(fields_));
  node_.fields = fields.data();
  node_.field_count = static_cast<std::uint32_t>(fields.size());
  document_.nodes.push_back(node_);
  return {static_cast<std::uint32_t>(document_.nodes.size() - 1), node_.at};
}

}  // namespace peerd::formats
