#include "peerd/peer/node/edit_operation.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "core/vrml/document.hpp"
#include "peerd/peer/node/node_tree.hpp"

namespace peerd {
namespace {

using namespace replication;
using config::SceneEdit;

constexpr std::string_view kHeader = "#VRML V2.0 utf8";

std::expected<ObjectId, std::string> find(const Scene& scene, const std::string& path) {
  if (const auto object = scene.find(path)) return *object;
  return std::unexpected("the scene has no " + path);
}

std::expected<std::optional<ObjectId>, std::string> find_parent(const Scene& scene, const std::string& under) {
  if (under.empty()) return std::optional<ObjectId>();
  auto parent = find(scene, under);
  if (!parent) return std::unexpected(parent.error());
  return std::optional(*parent);
}

}  // namespace

std::expected<NodeId, std::string> find_node(const Scene& scene, const std::string& path) {
  const auto node = node_at(scene, path);
  if (!node) return std::unexpected("the scene has no " + path);
  return scene.document->ids.id_of(*node);
}

bool is_about_ownership(const SceneEdit& edit) {
  using enum SceneEdit::Kind;
  return edit.kind == kOwn || edit.kind == kGrab || edit.kind == kSteal || edit.kind == kRelease;
}

bool is_undo(const SceneEdit& edit) {
  return edit.kind == SceneEdit::Kind::kUndo || edit.kind == SceneEdit::Kind::kRedo;
}

std::string name_of(const UndoneEdit& undone) {
  return fmt::format("operation {}:{} ({})", undone.edit.author.value, undone.edit.number, undone.kind);
}

std::expected<OperationBody, std::string> operation_of(const SceneEdit& edit, const Scene& scene, PeerId self) {
  switch (edit.kind) {
    case SceneEdit::Kind::kAdd: {
      const auto parent = find_parent(scene, edit.under);
      if (!parent) return std::unexpected(parent.error());
      const bool has_header = edit.text.starts_with(kHeader);
      return AddNodes{*parent, {}, has_header ? edit.text : std::string(kHeader) + "\n" + edit.text, 0, 0};
    }
    case SceneEdit::Kind::kRemove: {
      if (const auto object = scene.find(edit.path)) return RemoveObject{*object};
      const auto node = find_node(scene, edit.path);
      if (!node) return std::unexpected(node.error());
      return RemoveNode{*node};
    }
    case SceneEdit::Kind::kMove: {
      const auto object = find(scene, edit.path);
      const auto parent = find_parent(scene, edit.under);
      if (!object || !parent) return std::unexpected(!object ? object.error() : parent.error());
      return MoveObject{*object, *parent, {}};
    }
    case SceneEdit::Kind::kSet: {
      const auto node = find_node(scene, edit.path);
      if (!node) return std::unexpected(node.error());
      return SetField{*node, edit.field, edit.value, 0};
    }
    case SceneEdit::Kind::kData: {
      const auto node = find_node(scene, edit.path);
      if (!node) return std::unexpected(node.error());
      return SetData{*node, edit.key, edit.removes ? std::nullopt : std::optional(edit.data)};
    }
    case SceneEdit::Kind::kLock:
    case SceneEdit::Kind::kUnlock: {
      const auto object = find(scene, edit.path);
      if (!object) return std::unexpected(object.error());
      return LockObject{*object, edit.kind == SceneEdit::Kind::kUnlock};
    }
    case SceneEdit::Kind::kSend:
      return SendMessage{self, edit.key, edit.data};
    case SceneEdit::Kind::kOwn:
    case SceneEdit::Kind::kGrab:
    case SceneEdit::Kind::kSteal:
    case SceneEdit::Kind::kRelease:
    case SceneEdit::Kind::kUndo:
    case SceneEdit::Kind::kRedo:
      break;
  }
  return std::unexpected("there is no such edit");
}

std::string name_of(const SceneEdit& edit) {
  const std::string_view kind = to_string(edit.kind);
  switch (edit.kind) {
    case SceneEdit::Kind::kAdd:
      return fmt::format("{} {}{}", kind, edit.under.empty() ? "at the top level" : "below ", edit.under);
    case SceneEdit::Kind::kRemove:
    case SceneEdit::Kind::kOwn:
    case SceneEdit::Kind::kGrab:
    case SceneEdit::Kind::kSteal:
    case SceneEdit::Kind::kRelease:
    case SceneEdit::Kind::kLock:
    case SceneEdit::Kind::kUnlock:
      return fmt::format("{} {}", kind, edit.path);
    case SceneEdit::Kind::kMove:
      return fmt::format("{} {} {}{}", kind, edit.path, edit.under.empty() ? "to the top level" : "below ", edit.under);
    case SceneEdit::Kind::kSet:
      return fmt::format("{} {} {} {}", kind, edit.path, edit.field, edit.value);
    case SceneEdit::Kind::kData:
      return fmt::format("{} {} {}{}", kind, edit.path, edit.key, edit.removes ? " removed" : "");
    case SceneEdit::Kind::kUndo:
    case SceneEdit::Kind::kRedo:
      return fmt::format("{}{}{}", kind, edit.path.empty() ? "" : " of ", edit.path);
    case SceneEdit::Kind::kSend:
      return fmt::format("{} {}", kind, edit.key);
  }
  return "";
}

LogLine describe(const EditReport& report) {
  if (report.done()) {
    return {LogLevel::kInfo, fmt::format("{}: operation {}:{}", name_of(report.edit), report.operation->author.value,
                                         report.operation->number)};
  }
  return {LogLevel::kWarning, fmt::format("{} is not done: {}", name_of(report.edit), report.refused)};
}

std::string path_or_id(const Scene& scene, ObjectId object) {
  return scene.contains(object) ? scene.path_of(object) : fmt::format("object {}:{}", object.origin, object.number);
}

std::string path_or_id(const Scene& scene, NodeId node) {
  const vrml::Document& document = *scene.document;
  const auto index = document.ids.find(node, document.nodes.size());
  if (!index) return fmt::format("node {}:{}", node.origin, node.number);
  const auto instance = std::ranges::find(scene.instances, *index, &Instance::node);
  if (instance != scene.instances.end()) {
    return scene.path_of(scene.id_of(static_cast<std::uint32_t>(instance - scene.instances.begin())));
  }
  const std::string_view def = document.nodes[*index].def;
  return def.empty() ? fmt::format("node {}:{}", node.origin, node.number) : std::string(def);
}

}  // namespace peerd
