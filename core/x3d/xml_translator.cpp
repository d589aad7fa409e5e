#include "core/x3d/xml_translator.hpp"

#include <algorithm>
#include <array>

#include "core/x3d/extra_fields.hpp"
#include "core/x3d/x3d_words.hpp"

namespace peerd::vrml {
namespace {

// Elements nest no deeper. Each node is one level, and so is each ProtoDeclare, field and fieldValue.
constexpr std::uint32_t kMaxElements = 1024;

// Attributes that are no fields of a node.
bool is_no_field(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames{"DEF", "USE", "containerField", "class", "id", "style"};
  return std::ranges::find(kNames, name) != kNames.end() || name.starts_with("xmlns") ||
         name.find(':') != std::string_view::npos;
}

bool is_blank(std::string_view text) { return text.find_first_not_of(" \t\r\n") == std::string_view::npos; }

}  // namespace

// A tag begins with its "<".
std::size_t XmlTranslator::at(Element element) const { return static_cast<std::size_t>(element.name() - copy_) - 1; }
std::size_t XmlTranslator::at(pugi::xml_attribute attribute) const {
  return static_cast<std::size_t>(attribute.value() - copy_);
}

std::optional<pugi::xml_attribute> XmlTranslator::wanted(Element element, const char* name) {
  const pugi::xml_attribute attribute = element.attribute(name);
  if (attribute && *attribute.value() != '\0') return attribute;
  writer_.fault(at(element), std::string(element.name()) + " wants the attribute " + quoted(name), "it is left out");
  return std::nullopt;
}

bool XmlTranslator::enter(Element element) {
  if (depth_ < kMaxElements) return ++depth_, true;
  if (!std::exchange(too_deep_, true)) {
    writer_.error(at(element), "elements are nested more than " + std::to_string(kMaxElements) + " deep");
  }
  return false;
}

ClassicText XmlTranslator::translate(Element root) {
  std::size_t scenes = 0;
  for (const Element child : root.children()) {
    const std::string_view name = child.name();
    if (child.type() != pugi::node_element) continue;
    if (name == "head") {
      head(child);
    } else if (name == "Scene" && scenes++ == 0) {
      content(child);
    } else {
      writer_.fault(at(child), "X3D has one head and one Scene; this " + std::string(name) + " is none of them",
                    "it is left out");
    }
  }
  if (scenes == 0) writer_.error(at(root), "this X3D has no Scene");
  return too_deep_ ? ClassicText{} : writer_.take();
}

void XmlTranslator::head(Element head) {
  for (const Element child : head.children()) {
    if (std::string_view(child.name()) != "unit") continue;  // meta and component say nothing that is kept
    const auto category = wanted(child, "category");
    const auto factor = wanted(child, "conversionFactor");
    if (!category || !factor) continue;
    writer_.word("UNIT", at(child));
    writer_.name(category->value(), at(*category));
    writer_.name("unit", at(*category));
    if (!writer_.value("SFDouble", "conversionFactor", factor->value(), at(*factor))) writer_.word("1", at(*factor));
    writer_.line();
  }
}

void XmlTranslator::content(Element around) {
  for (const Element child : around.children()) {
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
      if (!is_blank(child.value())) {
        writer_.warning(static_cast<std::size_t>(child.value() - copy_), "text between tags is not read");
      }
    } else if (child.type() == pugi::node_element && !statement(child)) {
      node(child);
    }
  }
}

bool XmlTranslator::statement(Element element) {
  const std::string_view name = element.name();
  if (name == "ROUTE") return route(element), true;
  if (name == "IMPORT" || name == "EXPORT") return import_or_export(element), true;
  if (name == "ProtoDeclare") return proto(element), true;
  if (name == "ExternProtoDeclare") return extern_proto(element), true;
  return false;
}

void XmlTranslator::route(Element element) {
  std::array<pugi::xml_attribute, 4> given;
  for (std::size_t i = 0; i < given.size(); ++i) {
    constexpr std::array<const char*, 4> kNames{"fromNode", "fromField", "toNode", "toField"};
    const auto found = wanted(element, kNames[i]);
    if (!found) return;
    given[i] = *found;
  }
  const auto& [from_node, from_field, to_node, to_field] = given;
  writer_.word("ROUTE", at(element));
  writer_.name(from_node.value(), at(from_node));
  writer_.word(".", at(from_field));
  writer_.name(from_field.value(), at(from_field));
  writer_.word("TO", at(to_node));
  writer_.name(to_node.value(), at(to_node));
  writer_.word(".", at(to_field));
  writer_.name(to_field.value(), at(to_field));
  writer_.line();
}

void XmlTranslator::import_or_export(Element element) {
  const bool imports = std::string_view(element.name()) == "IMPORT";
  const auto node = wanted(element, imports ? "importedDEF" : "localDEF");
  const auto from = imports ? wanted(element, "inlineDEF") : node;
  if (!node || !from) return;
  writer_.word(element.name(), at(element));
  if (imports) {
    writer_.name(from->value(), at(*from));
    writer_.word(".", at(*node));
  }
  writer_.name(node->value(), at(*node));
  if (const pugi::xml_attribute as = element.attribute("AS"); as && *as.value() != '\0') {
    writer_.word("AS", at(as));
    writer_.name(as.value(), at(as));
  }
  writer_.line();
}

void XmlTranslator::proto(Element element) {
  const auto name = wanted(element, "name");
  if (!name || !enter(element)) return;
  Proto proto;
  writer_.word("PROTO", at(element));
  writer_.name(name->value(), at(*name));
  writer_.word("[", at(element));
  interface(element.child("ProtoInterface"), true, proto);
  writer_.word("] {", at(element));
  scopes_.emplace_back();
  const Element body = element.child("ProtoBody");
  content(body);
  for (const Element child : body.children()) {
    const std::string_view first = child.name();
    const bool declares = first == "ProtoDeclare" || first == "ExternProtoDeclare" || first == "ROUTE";
    if (child.type() != pugi::node_element || declares) continue;
    proto.container = container_of_element(child, {});
    break;
  }
  scopes_.pop_back();
  writer_.word("}", at(element));
  writer_.line();
  scopes_.back().protos.insert_or_assign(name->value(), std::move(proto));
  --depth_;
}

void XmlTranslator::extern_proto(Element element) {
  const auto name = wanted(element, "name");
  if (!name) return;
  Proto proto;
  writer_.word("EXTERNPROTO", at(element));
  writer_.name(name->value(), at(*name));
  writer_.word("[", at(element));
  interface(element, false, proto);
  writer_.word("]", at(element));
  const pugi::xml_attribute url = element.attribute("url");
  if (!url || !writer_.value("MFString", "url", url.value(), at(url))) writer_.word("[ ]", at(element));
  writer_.line();
  scopes_.back().protos.insert_or_assign(name->value(), std::move(proto));
}

void XmlTranslator::interface(Element around, bool with_values, Proto& proto) {
  for (const Element field : around.children("field")) {
    declaration(field, with_values, nullptr);
    proto.fields.insert_or_assign(field.attribute("name").value(), field.attribute("type").value());
  }
}

// Writes a field of a PROTO or a Script; `links` are the connects of the Script.
void XmlTranslator::declaration(Element field, bool with_values, Links* links) {
  const auto access = wanted(field, "accessType"), type = wanted(field, "type"), name = wanted(field, "name");
  if (!access || !type || !name) return;
  const auto known = find_x3d_access(access->value());
  if (!known) {
    return writer_.fault(
        at(*access),
        "the accessType is initializeOnly, inputOnly, outputOnly or inputOutput, and not " + quoted(access->value()),
        "the field is left out");
  }
  writer_.word(access->value(), at(*access));
  writer_.name(type->value(), at(*type));
  writer_.name(name->value(), at(*name));
  const auto link = links == nullptr ? Links::iterator{} : links->find(name->value());
  if (links != nullptr && link != links->end()) {
    link->second.written = true;
    writer_.word("IS", link->second.at);
    writer_.name(link->second.proto_field, link->second.at);
  } else if (with_values && has_value(*known)) {
    declared_value(field, type->value());
  }
  writer_.line();
}

void XmlTranslator::declared_value(Element field, std::string_view type) {
  if (type == "SFNode" || type == "MFNode") {
    if (!enter(field)) return;
    if (type == "MFNode") writer_.word("[", at(field));
    const std::size_t before = writer_.size();
    content(field);
    if (type == "MFNode") {
      writer_.word("]", at(field));
    } else if (writer_.size() == before) {
      writer_.word("NULL", at(field));
    }
    --depth_;
    return;
  }
  const pugi::xml_attribute value = field.attribute("value");
  if (!value || !writer_.value(type, field.attribute("name").value(), value.value(), at(value))) {
    writer_.default_value(type, at(field));
  }
}

const XmlTranslator::Proto* XmlTranslator::find_proto(std::string_view name) const {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
    if (const auto found = scope->protos.find(name); found != scope->protos.end()) return &found->second;
  }
  return nullptr;
}

void XmlTranslator::use(Element element) {
  const pugi::xml_attribute def = element.attribute("DEF");
  if (def && *def.value() != '\0') {
    writer_.fault(at(def), "a node with USE is another one, and has no DEF of its own", "the DEF is left out");
  }
  const auto use = wanted(element, "USE");
  if (!use) return;
  if (element.first_child()) {
    writer_.warning(at(element), "a node with USE is another one: what stands in it here is left out");
  }
  // A node whose DEF stands in one that is left out is written where it is used first.
  auto& left_out = scopes_.back().left_out;
  const auto found = left_out_around_ ? left_out.end() : left_out.find(use->value());
  const std::string_view type = found == left_out.end() ? "" : found->second.name();
  if (type == "ProtoInstance" || find_x3d_type(type) != nullptr) {
    const Element first = found->second;
    left_out.erase(found);
    return node(first);
  }
  writer_.word("USE", at(element));
  writer_.name(use->value(), at(*use));
  writer_.line();
}

void XmlTranslator::node(Element element) {
  if (element.attribute("USE")) return use(element);
  const bool instance = std::string_view(element.name()) == "ProtoInstance";
  const auto name = instance ? wanted(element, "name") : std::nullopt;
  if ((instance && !name) || !enter(element)) return;
  if (const pugi::xml_attribute def = element.attribute("DEF"); def && *def.value() != '\0') {
    writer_.word("DEF", at(element));
    writer_.name(def.value(), at(def));
    auto& left_out = scopes_.back().left_out;
    if (left_out_around_) {
      left_out.insert_or_assign(def.value(), element);
    } else {
      left_out.erase(def.value());
    }
  }
  Type type;
  if (instance) {
    writer_.name(name->value(), at(*name));
    if (const Proto* const proto = find_proto(name->value())) type.interface = &proto->fields;
  } else {
    writer_.name(element.name(), at(element));
    type.built_in = find_x3d_type(element.name());
  }
  writer_.word("{", at(element));
  if (type.built_in != nullptr || type.interface != nullptr) {
    fields(element, type);
  } else {
    names_in(element);
  }
  writer_.word("}", at(element));
  writer_.line();
  --depth_;
}

// The names in a node that is left out are written, so that nobody takes a USE of them for a mistake.
void XmlTranslator::names_in(Element element) {
  for (Element inner = element.first_child(); inner;) {
    if (const pugi::xml_attribute def = inner.attribute("DEF"); def && *def.value() != '\0') {
      writer_.word("DEF", at(inner));
      writer_.name(def.value(), at(def));
      scopes_.back().left_out.insert_or_assign(def.value(), inner);
    }
    if (inner.first_child()) {
      inner = inner.first_child();
      continue;
    }
    while (inner && inner != element && !inner.next_sibling()) inner = inner.parent();
    if (!inner || inner == element) return;
    inner = inner.next_sibling();
  }
}

std::optional<std::string_view> XmlTranslator::field_type(const Type& type, std::string_view field) {
  if (type.interface != nullptr) {
    const auto found = type.interface->find(field);
    if (found != type.interface->end()) return found->second;
    return field == "metadata" ? std::optional<std::string_view>("SFNode") : std::nullopt;
  }
  if (type.built_in == nullptr) return std::nullopt;
  const FieldSpec* const spec = find_field(*type.built_in, vrml_field_name(type.built_in->name, field));
  if (spec != nullptr && spec->access != Access::kContent) return name_of(spec->type);
  const ExtraField* const extra = find_extra_field(type.built_in->name, field);
  return extra == nullptr ? std::nullopt : std::optional(extra->type);
}

bool XmlTranslator::keeps(const Type& type, std::string_view field) {
  if (type.interface != nullptr) return type.interface->contains(field);
  const FieldSpec* const spec = find_field(*type.built_in, vrml_field_name(type.built_in->name, field));
  return spec != nullptr && spec->access != Access::kContent;
}

XmlTranslator::Links XmlTranslator::links_of(Element element) {
  Links links;
  for (const Element is : element.children("IS")) {
    for (const Element connect : is.children("connect")) {
      const auto node_field = wanted(connect, "nodeField"), proto_field = wanted(connect, "protoField");
      if (!node_field || !proto_field) continue;
      links.insert_or_assign(node_field->value(), Link{proto_field->value(), at(connect)});
    }
  }
  return links;
}

void XmlTranslator::write(const Links& links) {
  for (const auto& [field, link] : links) {
    if (link.written) continue;
    writer_.name(field, link.at);
    writer_.word("IS", link.at);
    writer_.name(link.proto_field, link.at);
  }
}

void XmlTranslator::fields(Element element, const Type& type) {
  Links connects = links_of(element);
  const bool script = type.built_in != nullptr && type.built_in->role == NodeRole::kScript;
  if (script) {
    for (const Element field : element.children("field")) declaration(field, true, &connects);
  }
  write(connects);
  std::string_view url;
  std::size_t url_at = 0;
  attributes(element, type, url, url_at);
  if (script) script_url(element, url, url_at);
  children(element, type);
}

// Writes the attributes that are fields, but for the url of a Script, which its source may follow.
void XmlTranslator::attributes(Element element, const Type& type, std::string_view& url, std::size_t& url_at) {
  const bool script = type.built_in != nullptr && type.built_in->role == NodeRole::kScript;
  const bool instance = type.built_in == nullptr;
  for (const pugi::xml_attribute one : element.attributes()) {
    const std::string_view name = one.name();
    if (is_no_field(name) || (instance && name == "name")) continue;
    if (script && name == "url") {
      url = one.value();
      url_at = at(one);
    } else {
      attribute(one, type);
    }
  }
}

void XmlTranslator::attribute(pugi::xml_attribute attribute, const Type& type) {
  const std::size_t before = writer_.size();
  const auto name_at = static_cast<std::size_t>(attribute.name() - copy_);
  writer_.name(attribute.name(), name_at);
  // An attribute that is no field is written as text, for the reader of nodes to name.
  const std::string_view value_type = field_type(type, attribute.name()).value_or("SFString");
  if (!writer_.value(value_type, attribute.name(), attribute.value(), at(attribute))) writer_.cut(before);
}

void XmlTranslator::script_url(Element element, std::string_view url, std::size_t url_at) {
  const std::size_t before = writer_.size();
  bool any = !url.empty();
  writer_.word("url", at(element));
  if (!any) writer_.word("[", at(element));
  if (any && !writer_.value("MFString", "url", url, url_at)) any = false;
  if (any) writer_.cut(writer_.size() - 2);  // the bracket at its end
  for (const Element child : element.children()) {
    if (child.type() != pugi::node_cdata || is_blank(child.value())) continue;
    any = true;
    std::string_view source = child.value();
    const auto offset = static_cast<std::size_t>(child.value() - copy_);
    source.remove_prefix(std::min(source.find_first_not_of(" \t\r\n"), source.size()));
    writer_.source(source, offset);
  }
  writer_.word("]", at(element));
  if (!any) writer_.cut(before);
}

std::string_view XmlTranslator::container_of_element(Element element, const Type& around) const {
  if (const pugi::xml_attribute given = element.attribute("containerField")) return given.value();
  const std::string_view name = element.name();
  const NodeType* const type = find_x3d_type(name);
  std::string_view container = container_of(name);
  if (name == "ProtoInstance") {
    if (const Proto* const proto = find_proto(element.attribute("name").value())) container = proto->container;
  }
  const bool metadata = name.starts_with("Metadata") && is_unkept_x3d_node(name);
  if (metadata && !field_type(around, container)) return "metadata";  // but in a MetadataSet
  if (around.built_in == nullptr || field_type(around, container)) return container;
  // A node that belongs nowhere by its name goes where nodes of its kind do: a MovieTexture to the source of a Sound.
  const std::uint16_t classes = type == nullptr ? 0 : type->classes;
  for (const FieldSpec& field : around.built_in->fields) {
    if (holds_nodes(field.type) && has_value(field.access) && (field.accepts & classes) != 0) return field.name;
  }
  return container;
}

void XmlTranslator::children(Element element, const Type& type) {
  std::vector<Part> parts;
  std::map<std::string_view, std::size_t> place_of;  // of a field's part
  const bool script = type.built_in != nullptr && type.built_in->role == NodeRole::kScript;
  bool text_reported = false;
  for (const Element child : element.children()) {
    const std::string_view name = child.name();
    const bool text = child.type() == pugi::node_pcdata || (child.type() == pugi::node_cdata && !script);
    if (text && !is_blank(child.value()) && !std::exchange(text_reported, true)) {
      writer_.warning(static_cast<std::size_t>(child.value() - copy_), "text between tags is not read");
    }
    if (child.type() != pugi::node_element || name == "IS") continue;
    if (name == "field") {
      if (!script) writer_.fault(at(child), "a field is declared by a Script, and by no other node", "it is left out");
      continue;
    }
    if (name == "fieldValue") {
      field_value(child, type);
      continue;
    }
    const bool says = name == "ROUTE" || name == "ProtoDeclare" || name == "ExternProtoDeclare" || name == "IMPORT" ||
                      name == "EXPORT";
    const std::string_view field = says ? std::string_view{} : container_of_element(child, type);
    // A statement stands in the list before it, where it came in the file.
    if (says && !parts.empty() && field_type(type, parts.back().field).value_or("").starts_with("MF")) {
      parts.back().elements.push_back(child);
      continue;
    }
    const auto [same, is_new] = says ? std::pair(place_of.end(), true) : place_of.try_emplace(field, parts.size());
    if (is_new) {
      parts.push_back({field, {child}});
    } else {
      parts[same->second].elements.push_back(child);
    }
  }
  for (const Part& one : parts) part(one, type);
}

void XmlTranslator::part(const Part& part, const Type& type) {
  if (part.field.empty()) {
    for (const Element element : part.elements) static_cast<void>(statement(element));
    return;
  }
  const Element first = part.elements.front();
  writer_.name(part.field, at(first));
  const bool list = !field_type(type, part.field).value_or("MFNode").starts_with("SF");
  if (list) writer_.word("[", at(first));
  bool full = false;
  const bool around = std::exchange(left_out_around_, left_out_around_ || !keeps(type, part.field));
  for (const Element element : part.elements) {
    if (statement(element)) continue;
    if (!list && std::exchange(full, true)) {
      if (part.field == "metadata") continue;
      writer_.fault(at(element), quoted(part.field) + " is one node, and this is another", "it is left out");
      continue;
    }
    const std::size_t before = writer_.size();
    node(element);
    if (!list && writer_.size() == before) writer_.word("NULL", at(element));
  }
  left_out_around_ = around;
  if (list) writer_.word("]", at(first));
}

void XmlTranslator::field_value(Element element, const Type& type) {
  const auto name = wanted(element, "name");
  if (!name) return;
  const std::size_t before = writer_.size();
  writer_.name(name->value(), at(*name));
  const std::string_view value_type = field_type(type, name->value()).value_or("SFString");
  const pugi::xml_attribute value = element.attribute("value");
  if (value && value_type != "SFNode" && value_type != "MFNode") {
    if (!writer_.value(value_type, name->value(), value.value(), at(value))) writer_.cut(before);
  } else if (value_type == "SFNode" || value_type == "MFNode") {
    declared_value(element, value_type);
  } else {
    writer_.fault(at(element), quoted(name->value()) + " has no value", "it is left out");
    writer_.cut(before);
  }
}

}  // namespace peerd::vrml
