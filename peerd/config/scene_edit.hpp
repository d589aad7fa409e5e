#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace peerd::config {

// A change of the scene, or of who owns what in it, as people and scripts ask for it: paths are as in a world file
// (Scene::find).
struct SceneEdit {
  enum class Kind : std::uint8_t { kAdd, kRemove, kMove, kSet, kOwn, kGrab, kRelease };
  Kind kind{};
  // The thing to remove, move, set, own or release: an instance, or, to be removed or set, a node by its DEF name.
  std::string path;
  std::string text;          // kAdd: VRML, with or without its first line
  std::string under;         // kAdd, kMove: the new parent; empty: the top level
  std::string field, value;  // kSet: in the notation of VRML
};

// The word for a kind in scenarios, requests and logs.
[[nodiscard]] constexpr std::string_view to_string(SceneEdit::Kind kind) {
  switch (kind) {
    case SceneEdit::Kind::kAdd:
      return "add";
    case SceneEdit::Kind::kRemove:
      return "remove";
    case SceneEdit::Kind::kMove:
      return "move";
    case SceneEdit::Kind::kSet:
      return "set";
    case SceneEdit::Kind::kOwn:
      return "own";
    case SceneEdit::Kind::kGrab:
      return "grab";
    case SceneEdit::Kind::kRelease:
      return "release";
  }
  return "?";
}

// An edit that a peer makes by itself: an event of such a kind.
struct ScriptedEdit {
  double at_s = 0.0;  // after the scenario's start
  SceneEdit edit;
};

}  // namespace peerd::config
