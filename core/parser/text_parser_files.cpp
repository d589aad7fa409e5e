// TextParser: Inlines, and the files behind URLs.
#include <algorithm>
#include <utility>

#include "core/parser/text_parser.hpp"

namespace peerd::vrml {

using enum TokenKind;

bool TextParser::is_open(std::string_view name) const {
  return std::ranges::find(context_.open_files, name) != context_.open_files.end();
}

// The file behind a URL, read and unpacked, now at the end of open_files; or null, and why.
ParseContext::File* TextParser::open_file(std::string_view url, Position at, std::string& why) {
  if (!context_.options.load) {
    why = "no other file is read here";
    return nullptr;
  }
  std::expected<LoadedFile, std::string> loaded = context_.options.load(url, problems_.name_of(at));
  if (!loaded) {
    why = loaded.error();
    return nullptr;
  }
  if (is_open(loaded->name)) {
    why = "that file is being read already: it contains itself";
    tokens_.error(at, quoted(url) + ": " + why);
    return nullptr;
  }
  if (context_.open_files.size() >= kMaxOpenFiles) {
    why = "files are nested more than " + std::to_string(kMaxOpenFiles) + " deep";
    tokens_.error(at, quoted(url) + ": " + why);
    return nullptr;
  }
  const auto [it, is_new] = context_.files.try_emplace(loaded->name);
  ParseContext::File& file = it->second;
  if (is_new) {
    Source source{it->first, {}, std::make_shared<const std::string>(std::move(loaded->bytes))};
    source.text = *source.owned;
    const auto opened = open_text(context_, std::move(source));
    if (opened) {
      file = {.begin = opened->begin, .body = opened->body, .readable = true};
    } else {
      file.why = opened.error();
    }
  }
  if (!file.readable) {
    why = file.why;
    return nullptr;
  }
  context_.open_files.push_back(it->first);
  return &file;
}

// The nodes that an Inline stands for, from the first of its URLs behind which there is a file.
const std::vector<NodeRef>* TextParser::load_content(const Field& url) {
  std::string tried;
  const std::size_t errors = problems_.errors();
  for (const std::string_view one : url.as<std::string_view>()) {
    std::string why;
    ParseContext::File* const file = open_file(one.substr(0, one.find('#')), url.at, why);
    if (file != nullptr) {
      if (!file->content) {
        const std::size_t first = context_.world.roots.size();
        TextParser(context_, file->begin, file->body, nesting_).parse_text(context_.world);
        auto& roots = context_.world.roots;
        file->content.emplace(roots.begin() + static_cast<std::ptrdiff_t>(first), roots.end());
        roots.resize(first);
      }
      context_.open_files.pop_back();
      return &*file->content;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(one) + ": " + why;
  }
  if (!tried.empty() && problems_.errors() == errors) {
    tokens_.warning(url.at, "this Inline stays empty: " + tried);
  }
  return nullptr;
}

// Before a prototype's Inlines come into the world: nodes stand behind what they refer to.
void TextParser::load_inlines_of(const Prototype& prototype, std::span<const Field> given) {
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

bool TextParser::is_deferred(Position inline_at, const Field* box_size) const {
  if (!context_.options.defer_inlines || box_size == nullptr) return false;
  const std::span<const float> size = box_size->as<float>();
  const bool sized = size[0] >= 0 && size[1] >= 0 && size[2] >= 0;
  return sized && !context_.options.undeferred_inlines.contains(problems_.place_of(inline_at));
}

void TextParser::fill_inline(Node& node) {
  const Field* url = node.find("url");
  if (url == nullptr) return;
  if (is_deferred(node.at, node.find("bboxSize"))) return;
  const std::vector<NodeRef>* content = load_content(*url);
  std::vector<Field> fields(node.given().begin(), node.given().end());
  const auto refs = arena_.copy(content != nullptr ? std::span<const NodeRef>(*content) : std::span<const NodeRef>());
  fields.push_back({&inline_content(), refs.data(), static_cast<std::uint32_t>(refs.size()), url->at});
  const auto kept = arena_.copy(std::span<const Field>(fields));
  node.fields = kept.data();
  node.field_count = static_cast<std::uint32_t>(kept.size());
}

}  // namespace peerd::vrml
