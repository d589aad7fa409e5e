#include "core/parser/type_finder.hpp"

#include <algorithm>
#include <string>

#include "core/parser/included_file.hpp"
#include "core/x3d/x3d_words.hpp"

namespace peerd::vrml {

TypeFinder::Type TypeFinder::find(const Token& name) {
  for (Scope* scope = text_.scope; scope != nullptr; scope = scope->outer) {
    const auto it = scope->declarations.find(name.text);
    if (it == scope->declarations.end()) continue;
    Declaration& declaration = it->second;
    resolve(declaration, it->first);
    if (declaration.native != nullptr) return {declaration.native, nullptr};
    const Prototype* const prototype = declaration.prototype;
    return {prototype->not_found != nullptr ? prototype->not_found : &prototype->type, prototype};
  }
  return {text_.is_x3d ? find_x3d_type(name.text) : find_node_type(name.text), nullptr};
}

// A world may declare our own nodes, by their names or by URN, so that browsers that don't know them find a PROTO.
void TypeFinder::add_native(Declaration& declaration, std::string_view name) {
  if (std::ranges::find(kExtensionNodes, name) != std::end(kExtensionNodes)) declaration.native = find_node_type(name);
  for (const std::string_view url : declaration.urls) {
    if (url.starts_with(kExtensionUrn)) declaration.native = find_node_type(url.substr(kExtensionUrn.size()));
  }
  if (declaration.native != nullptr && !fits(declaration.interface, *declaration.native, declaration.at)) {
    declaration.native = nullptr;
  }
}

// Returns whether each field of `interface` is one of `type`, of the same type and with an access that serves it
// (4.9.2).
bool TypeFinder::fits(std::span<const FieldSpec> interface, const NodeType& type, Position at) {
  bool good = true;
  for (const FieldSpec& declared : interface) {
    const FieldSpec* field = find_field(type, declared.name);
    // An exposedField x has the events set_x and x_changed (4.7).
    const std::string_view name = declared.name;
    const FieldSpec* exposed = nullptr;
    if (declared.access == Access::kEventIn && name.starts_with("set_")) exposed = find_field(type, name.substr(4));
    if (declared.access == Access::kEventOut && name.ends_with("_changed")) {
      exposed = find_field(type, name.substr(0, name.size() - 8));
    }
    const bool event = field == nullptr && exposed != nullptr && exposed->access == Access::kExposedField;
    if (event && exposed->type == declared.type) continue;
    std::string why;
    if (field == nullptr) {
      Suggestion suggestion(declared.name);
      for (const FieldSpec& other : type.fields) suggestion.consider(other.name);
      why = "has no field " + quoted(declared.name) + did_you_mean(suggestion);
    } else if (field->type != declared.type) {
      why = "has " + quoted(declared.name) + " as " + std::string(name_of(field->type)) + ", not " +
            std::string(name_of(declared.type));
    } else if (field->access != declared.access &&
               !(field->access == Access::kExposedField && declared.access == Access::kField)) {
      why = "has " + quoted(declared.name) + " as " + std::string(name_of(field->access)) + ", not " +
            std::string(name_of(declared.access));
    } else {
      continue;
    }
    text_.tokens.fault(at, "this declaration does not fit: " + std::string(type.name) + ' ' + why,
                       "its instances stay empty");
    good = false;
  }
  return good;
}

// Looks for what an EXTERNPROTO declares. Where nothing is found its instances are empty nodes with its interface.
void TypeFinder::resolve(Declaration& declaration, std::string_view name) {
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  std::string tried;
  bool misfit = false;
  declaration.resolving = true;
  ++text_.context.resolving;
  for (const std::string_view url : declaration.urls) {
    std::string why;
    const Declaration* const found = find_in_library(url, declaration.at, why);
    if (found != nullptr) {
      const NodeType& type = found->native != nullptr ? *found->native : found->prototype->type;
      misfit = !fits(declaration.interface, type, declaration.at);
      if (misfit) break;
      declaration.native = found->native;
      declaration.prototype = found->prototype;
      break;
    }
    tried += (tried.empty() ? "" : "; ") + quoted(url) + ": " + why;
  }
  declaration.resolving = false;
  --text_.context.resolving;
  if (declaration.prototype != nullptr && text_.units.length != 1.0) {
    text_.tokens.warning(declaration.at, "the lengths in the PROTO of another file are taken in the UNIT of this one");
  }
  if (declaration.prototype != nullptr || declaration.native != nullptr) return;
  if (tried.empty()) tried = "it has no URL";
  if (!misfit) {
    text_.tokens.warning(declaration.at,
                         "EXTERNPROTO " + quoted(name) + " is not found, its instances stay empty: " + tried);
  }
  Prototype& empty = text_.context.prototypes.emplace_back();
  empty.not_found = &text_.context.document.own_types.emplace_back(
      NodeType{text_.arena.copy(name), kAnyClass, NodeRole::kPart, declaration.interface});
  empty.type = *empty.not_found;
  declaration.prototype = &empty;
}

const Declaration* TypeFinder::find_in_library(std::string_view url, Position at, std::string& why) {
  const std::size_t hash = std::min(url.find('#'), url.size());
  ParseContext::File* const file = open_file(text_, url.substr(0, hash), at, why);
  if (file == nullptr) return nullptr;
  if (file->other) {
    text_.context.open_files.pop_back();
    why = "it is of a format that has no PROTOs";
    return nullptr;
  }
  if (!file->library) {
    Body unused;
    file->library = text_.context.parse_text(file->text, text_.nesting, unused);
    text_.context.node_eighths -= 8 * unused.nodes.size();
  }
  text_.context.open_files.pop_back();
  if (hash < url.size()) {
    const auto it = file->library->find(url.substr(hash + 1));
    if (it == file->library->end()) {
      why = "it has no PROTO of that name";
      return nullptr;
    }
    if (it->second.resolving) {
      why = "it is declared by way of itself";
      text_.tokens.fault(at, quoted(url) + ": " + why, "its instances stay empty");
      return nullptr;
    }
    if (text_.context.resolving >= kMaxResolving) {
      why = "EXTERNPROTOs lead to one another more than " + std::to_string(kMaxResolving) + " times";
      text_.tokens.error(at, quoted(url) + ": " + why);
      return nullptr;
    }
    resolve(it->second, it->first);
    if (it->second.native != nullptr || it->second.prototype->not_found == nullptr) return &it->second;
    why = "it is not found there either";
    return nullptr;
  }
  // A URL without a name means the first PROTO of the file (4.9.3).
  Declaration* first = nullptr;
  for (auto& [name, declaration] : *file->library) {
    if (!declaration.external && (first == nullptr || declaration.at < first->at)) first = &declaration;
  }
  if (first == nullptr) why = "it has no PROTO";
  return first;
}

}  // namespace peerd::vrml
