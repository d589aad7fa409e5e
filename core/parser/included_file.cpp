#include "core/parser/included_file.hpp"

#include <algorithm>
#include <expected>
#include <memory>
#include <utility>

namespace peerd::vrml {

namespace {

bool is_open(const ParseContext& context, std::string_view name) {
  return std::ranges::find(context.open_files, name) != context.open_files.end();
}

}  // namespace

ParseContext::File* open_file(TextState& text, std::string_view url, Position at, std::string& why) {
  if (!text.context.options.load) {
    why = "no other file is read here";
    return nullptr;
  }
  std::expected<LoadedFile, std::string> loaded = text.context.options.load(url, text.problems.name_of(at));
  if (!loaded) {
    why = loaded.error();
    return nullptr;
  }
  if (is_open(text.context, loaded->name)) {
    why = "that file is being read already: it contains itself";
    text.tokens.fault(at, quoted(url) + ": " + why, "nothing is read there");
    return nullptr;
  }
  if (text.context.open_files.size() >= kMaxOpenFiles) {
    why = "files are nested more than " + std::to_string(kMaxOpenFiles) + " deep";
    text.tokens.error(at, quoted(url) + ": " + why);
    return nullptr;
  }
  const auto [it, is_new] = text.context.files.try_emplace(loaded->name);
  ParseContext::File& file = it->second;
  if (is_new) {
    Source source{it->first, {}, std::make_shared<const std::string>(std::move(loaded->bytes))};
    source.text = *source.owned;
    if (text.context.read_other) {
      file.other = text.context.read_other(source, text.problems, text.context.options);
    }
    if (file.other) {
      file.readable = true;
    } else if (const auto opened = open_text(text.context, std::move(source))) {
      file = {.text = *opened, .readable = true};
    } else {
      file.why = opened.error().why;
    }
  }
  if (!file.readable) {
    why = file.why;
    return nullptr;
  }
  text.context.open_files.push_back(it->first);
  return &file;
}

}  // namespace peerd::vrml
