#include "peerd/view/picks/inspect.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/vrml/document.hpp"
#include "core/writer/text_writer.hpp"
#include "peerd/peer/node/node_tree.hpp"

namespace peerd::view {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kValue_bytes = 2000;  // of a value's text; what is longer is cut
// Elements that are written at all: they may be millions.
constexpr std::uint32_t kElements = 240;  // divisible by the number of floats in any value

std::string nodes_text(const vrml::Document& document, const vrml::Field& field) {
  std::string text;
  for (const vrml::NodeRef ref : field.as<vrml::NodeRef>()) {
    if (text.size() > kValue_bytes) break;
    if (!text.empty()) text += ", ";
    if (!ref.is_node()) {
      text += "NULL";
      continue;
    }
    const vrml::Node& node = document.nodes[ref.index];
    if (!node.def.empty()) text += "DEF " + std::string(node.def) + " ";
    text += std::string(node.type->name) + " { .. }";
  }
  return vrml::is_list(field.spec->type) ? "[ " + text + " ]" : text.empty() ? "NULL" : text;
}

std::string text_of(const vrml::Document& document, const vrml::Field& field) {
  if (vrml::holds_nodes(field.spec->type)) return nodes_text(document, field);
  vrml::Field shown = field;
  const bool is_cut = field.count > kElements && field.spec->type != vrml::FieldType::kSFImage;
  if (is_cut) shown.count = kElements;
  if (field.spec->type == vrml::FieldType::kSFImage && field.count > kElements) return "..";
  vrml::TextWriter writer;
  writer.value(shown);
  std::string text = writer.take();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (text.size() > kValue_bytes || is_cut) {
    text.resize(std::min(text.size(), kValue_bytes));
    text += " ..";
  }
  return text;
}

// Adds what the world's text, or an edit, gives the node, and what applications keep at it.
void add_fields_and_data(ordered_json& out, const replication::Peer& peer, const vrml::Document& document,
                         std::uint32_t index) {
  out["fields"] = ordered_json::object();
  out["data"] = ordered_json::object();
  for (const vrml::Field& field : document.nodes[index].given()) {
    if (vrml::has_value(field.spec->access)) out["fields"][std::string(field.spec->name)] = text_of(document, field);
  }
  const NodeId id = document.ids.id_of(index);
  for (const std::string& key : peer.data().keys(id)) {
    if (const std::string* const value = peer.data().find(id, key)) out["data"][key] = *value;
  }
}

}  // namespace

ordered_json inspect(const PeerNode& node, ObjectId object) {
  const replication::Peer& peer = node.peer();
  const Scene& scene = node.scene();
  const Instance& instance = scene.at(object);
  const vrml::Document& document = *scene.document;
  const PeerId owner = peer.owner(object);
  const bool own = owner == peer.id();
  const auto threshold_m = peer.threshold_m(object);
  const auto lock = peer.lock_around(object);
  ordered_json out = {{"id", std::to_string(object.packed())},
                      {"path", scene.path_of(object)},
                      {"def", instance.def},
                      {"type", document.nodes[instance.node].type->name},
                      {"owner", owner == kNobody ? ordered_json(nullptr) : ordered_json(owner.value)},
                      {"own", own},
                      {"driven", own && node.drives(object)},
                      {"threshold_m", threshold_m ? ordered_json(*threshold_m) : ordered_json(nullptr)},
                      {"locked_by", lock ? ordered_json(lock->by) : ordered_json(nullptr)}};
  add_fields_and_data(out, peer, document, instance.node);
  return out;
}

ordered_json inspect(const PeerNode& node, const std::string& path) {
  const Scene& scene = node.scene();
  if (const auto object = scene.find(path)) return inspect(node, *object);
  const auto index = node_at(scene, path);
  if (!index) return {{"ok", false}, {"error", "the scene has no " + path}};
  const vrml::Node& part = scene.document->nodes[*index];
  ordered_json out = {{"id", nullptr},           {"path", path},           {"def", part.def},
                      {"type", part.type->name}, {"owner", nullptr},       {"own", false},
                      {"driven", false},         {"threshold_m", nullptr}, {"locked_by", nullptr}};
  add_fields_and_data(out, node.peer(), *scene.document, *index);
  return out;
}

}  // namespace peerd::view
