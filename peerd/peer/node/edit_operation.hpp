#pragma once
#include <expected>
#include <optional>
#include <string>

#include "core/scene/scene.hpp"
#include "peerd/peer/config/scene_edit.hpp"
#include "peerd/peer/node/log_line.hpp"
#include "replication/wire/operation.hpp"

namespace peerd {

// An EditReport says what has become of an edit that a peer was asked for.
struct EditReport {
  config::SceneEdit edit;
  std::optional<replication::OperationId> operation;  // none: it was refused
  std::string refused;

  [[nodiscard]] bool done() const { return refused.empty(); }
};
[[nodiscard]] LogLine describe(const EditReport& report);

// Whether the edit changes who owns an object, and nothing else.
[[nodiscard]] bool is_about_ownership(const config::SceneEdit& edit);
[[nodiscard]] bool is_undo(const config::SceneEdit& edit);  // or a redo
// It is written as operation 7:12 (set).
[[nodiscard]] std::string name_of(const replication::UndoneEdit& undone);
// Finds a node as node_at() does; the error says that there is none.
[[nodiscard]] std::expected<NodeId, std::string> find_node(const Scene& scene, const std::string& path);
// The operation for any other edit of the scene as it is, by that peer; the error says which path names nothing.
[[nodiscard]] std::expected<replication::OperationBody, std::string> operation_of(const config::SceneEdit& edit,
                                                                                  const Scene& scene, PeerId self);

// An edit as a log names it: add below X, set WALL translation.
[[nodiscard]] std::string name_of(const config::SceneEdit& edit);

// The path of an instance; its id where it is not there any more.
[[nodiscard]] std::string path_or_id(const Scene& scene, ObjectId object);
// The path of the first instance of a node, or its DEF name; its id where it has neither.
[[nodiscard]] std::string path_or_id(const Scene& scene, NodeId node);

}  // namespace peerd
