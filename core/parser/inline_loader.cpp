#include "core/parser/inline_loader.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "core/parser/included_file.hpp"

namespace peerd::vrml {

// Returns the file that an Inline stands for, with its content: the first of its URLs behind which there is one.
const ParseContext::File* InlineLoader::load_content(const Field& url) {
  std::string tried;
  const std::size_t errors = text_.problems.errors();
  for (const std::string_view one : url.as<std::string_view>()) {
    std::string why;
    ParseContext::File* const file = open_file(text_, one.substr(0, one.find('#')), url.at, why);
    if (file != nullptr) {
      if (!file->content && file->other) file->content = adopt(file->other, url.at);
      if (!file->content) {
        const std::size_t first = text_.context.world.roots.size();
        static_cast<void>(text_.context.parse_text(file->text, text_.nesting, text_.context.world));
        auto& roots = text_.context.world.roots;
        file->content.emplace(roots.begin() + static_cast<std::ptrdiff_t>(first), roots.end());
        roots.resize(first);
      }
      text_.context.open_files.pop_back();
      return file;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(one) + ": " + why;
  }
  if (!tried.empty() && text_.problems.errors() == errors) {
    text_.tokens.warning(url.at, "this Inline stays empty: " + tried);
  }
  return nullptr;
}

std::vector<NodeRef> InlineLoader::adopt(const std::shared_ptr<const Document>& other, Position at) {
  Body& world = text_.context.world;
  const auto base = static_cast<std::uint32_t>(world.nodes.size());
  const auto shifted = [base](NodeRef ref) { return ref.is_node() ? NodeRef{ref.index + base, ref.at} : ref; };
  std::uint64_t references = 0;
  for (const Node& node : other->nodes) {
    for (const Field& field : node.given()) references += holds_nodes(field.spec->type) ? field.count : 0;
  }
  if (!text_.context.room_for(other->nodes.size(), references + other->routes.size(), at)) return {};
  world.references += references;
  const std::uint32_t scope = world.scopes++;
  for (Node node : other->nodes) {
    const auto fields = text_.arena.allocate<Field>(node.field_count);
    std::ranges::copy(node.given(), fields.begin());
    for (Field& field : fields) {
      if (!holds_nodes(field.spec->type)) continue;
      const auto refs = text_.arena.allocate<NodeRef>(field.count);
      std::ranges::transform(field.as<NodeRef>(), refs.begin(), shifted);
      field.data = refs.data();
    }
    node.fields = fields.data();
    node.scope = scope;
    world.nodes.push_back(node);
  }
  for (Route route : other->routes) {
    route.from_node += base;
    route.to_node += base;
    world.routes.push_back(route);
  }
  text_.context.document.arrays.push_back(other);  // has the values and the names
  std::vector<NodeRef> roots(other->top_level.size());
  std::ranges::transform(other->top_level, roots.begin(), shifted);
  return roots;
}

NodeRef add_scale(TextState& text, double factor, std::span<const NodeRef> nodes) {
  const NodeType& transform = *find_node_type("Transform");
  const auto scale = static_cast<float>(factor);
  const std::array<float, 3> scales{scale, scale, scale};
  const auto children = text.arena.copy(nodes);
  const std::array<Field, 2> fields{
      Field{find_field(transform, "scale"), text.arena.copy(std::span<const float>(scales)).data(), 3, text.begin},
      Field{find_field(transform, "children"), children.data(), static_cast<std::uint32_t>(children.size()),
            text.begin}};
  Body& world = text.context.world;
  world.references += children.size();
  world.nodes.push_back({.type = &transform,
                         .fields = text.arena.copy(std::span<const Field>(fields)).data(),
                         .at = text.begin,
                         .scope = text.scope->id,
                         .field_count = 2});
  return {static_cast<std::uint32_t>(world.nodes.size() - 1), text.begin};
}

void InlineLoader::load_all_of(const Prototype& prototype, std::span<const Field> given) {
  std::optional<std::vector<const Field*>> values;
  for (std::uint32_t i = 0; i < prototype.body.nodes.size(); ++i) {
    const Node& node = prototype.body.nodes[i];
    if (node.type->role != NodeRole::kInline) continue;
    if (!values) values = linked_values(prototype, given);
    const auto value = [&](std::string_view name) {
      const Field* field = node.find(name);
      for (const ValueLink& link : value_links_of(prototype, i)) {
        if (link.inner->name != name) continue;
        const std::optional<Field>& otherwise = prototype.defaults[prototype.linked_fields[link.value]];
        if ((*values)[link.value] != nullptr) {
          field = (*values)[link.value];
        } else if (otherwise) {
          field = &*otherwise;
        }
      }
      return field;
    };
    const Field* url = value("url");
    if (url != nullptr && !is_deferred(node.at, value("bboxSize"))) static_cast<void>(load_content(*url));
  }
}

bool InlineLoader::is_deferred(Position inline_at, const Field* box_size) const {
  if (!text_.context.options.defer_inlines || box_size == nullptr) return false;
  const std::span<const float> size = box_size->as<float>();
  const bool sized = size[0] >= 0 && size[1] >= 0 && size[2] >= 0;
  return sized && !text_.context.options.undeferred_inlines.contains(text_.problems.place_of(inline_at));
}

const ParseContext::File* InlineLoader::fill(Node& node) {
  const Field* url = node.find("url");
  if (url == nullptr) return nullptr;
  if (is_deferred(node.at, node.find("bboxSize"))) return nullptr;
  const ParseContext::File* const file = load_content(*url);
  std::vector<Field> fields(node.given().begin(), node.given().end());
  std::span<const NodeRef> content;
  if (file != nullptr) content = *file->content;
  // The file is in metres, and stands among numbers of this text's unit.
  NodeRef scaled;
  if (text_.units.length != 1.0 && !content.empty() && text_.context.room_for(1, content.size(), node.at)) {
    scaled = add_scale(text_, 1.0 / text_.units.length, content);
    content = std::span(&scaled, 1);
  }
  const auto refs = text_.arena.copy(content);
  fields.push_back({&inline_content(), refs.data(), static_cast<std::uint32_t>(refs.size()), url->at});
  const auto kept = text_.arena.copy(std::span<const Field>(fields));
  node.fields = kept.data();
  node.field_count = static_cast<std::uint32_t>(kept.size());
  return file;
}

}  // namespace peerd::vrml
