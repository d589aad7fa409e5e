#include "core/parser/inline_loader.hpp"

#include <optional>
#include <string>

#include "core/parser/included_file.hpp"

namespace peerd::vrml {

// The nodes that an Inline stands for, from the first of its URLs behind which there is a file.
const std::vector<NodeRef>* InlineLoader::load_content(const Field& url) {
  std::string tried;
  const std::size_t errors = text_.problems.errors();
  for (const std::string_view one : url.as<std::string_view>()) {
    std::string why;
    ParseContext::File* const file = open_file(text_, one.substr(0, one.find('#')), url.at, why);
    if (file != nullptr) {
      if (!file->content) {
        const std::size_t first = text_.context.world.roots.size();
        static_cast<void>(text_.context.parse_text({file->begin, file->body}, text_.nesting, text_.context.world));
        auto& roots = text_.context.world.roots;
        file->content.emplace(roots.begin() + static_cast<std::ptrdiff_t>(first), roots.end());
        roots.resize(first);
      }
      text_.context.open_files.pop_back();
      return &*file->content;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(one) + ": " + why;
  }
  if (!tried.empty() && text_.problems.errors() == errors) {
    text_.tokens.warning(url.at, "this Inline stays empty: " + tried);
  }
  return nullptr;
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

void InlineLoader::fill(Node& node) {
  const Field* url = node.find("url");
  if (url == nullptr) return;
  if (is_deferred(node.at, node.find("bboxSize"))) return;
  const std::vector<NodeRef>* content = load_content(*url);
  std::vector<Field> fields(node.given().begin(), node.given().end());
  const auto refs =
      text_.arena.copy(content != nullptr ? std::span<const NodeRef>(*content) : std::span<const NodeRef>());
  fields.push_back({&inline_content(), refs.data(), static_cast<std::uint32_t>(refs.size()), url->at});
  const auto kept = text_.arena.copy(std::span<const Field>(fields));
  node.fields = kept.data();
  node.field_count = static_cast<std::uint32_t>(kept.size());
}

}  // namespace peerd::vrml
