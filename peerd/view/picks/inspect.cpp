#include "peerd/view/picks/inspect.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/vrml/document.hpp"
#include "core/writer/text_writer.hpp"
#include "peerd/peer/node/edit_operation.hpp"

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
                      {"locked_by", lock ? ordered_json(lock->by) : ordered_json(nullptr)},
                      {"fields", ordered_json::object()},
                      {"data", ordered_json::object()}};
  for (const vrml::Field& field : document.nodes[instance.node].given()) {
    if (vrml::has_value(field.spec->access)) out["fields"][std::string(field.spec->name)] = text_of(document, field);
  }
  if (const auto at = find_node(scene, scene.path_of(object))) {
    for (const std::string& key : peer.data().keys(*at)) {
      if (const std::string* const value = peer.data().find(*at, key)) out["data"][key] = *value;
    }
  }
  return out;
}

}  // namespace peerd::view
