#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace peerd::config {

// A change of the scene, of data at its nodes, or of who owns or has locked what in it, or a message to all, as people
// and scripts ask for it: paths are as in a world file (Scene::find).
struct SceneEdit {
  enum class Kind : std::uint8_t {
    kAdd,
    kRemove,
    kMove,
    kSet,
    kOwn,
    kGrab,
    kSteal,
    kRelease,
    kData,
    kSend,
    kUndo,
    kRedo,
    kLock,
    kUnlock
  };
  Kind kind{};
  // The thing to remove, move, set, own, release, lock or unlock, or that has the data: an instance, or, to be removed
  // or set, or for data, a node by its DEF name.
  std::string path;
  std::string text;          // kAdd: VRML, with or without its first line
  std::string under;         // kAdd, kMove: the new parent; empty: the top level
  std::string field, value;  // kSet: in the notation of VRML
  std::string key, data;     // kData: the key and its value; kSend: the topic and the text. Any bytes
  bool removes = false;      // kData: the key is removed
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
    case SceneEdit::Kind::kSteal:
      return "steal";
    case SceneEdit::Kind::kRelease:
      return "release";
    case SceneEdit::Kind::kData:
      return "data";
    case SceneEdit::Kind::kSend:
      return "send";
    case SceneEdit::Kind::kUndo:
      return "undo";
    case SceneEdit::Kind::kRedo:
      return "redo";
    case SceneEdit::Kind::kLock:
      return "lock";
    case SceneEdit::Kind::kUnlock:
      return "unlock";
  }
  return "?";
}

// An edit that a peer makes by itself: an event of such a kind.
struct ScriptedEdit {
  double at_s = 0.0;  // after the scenario's start
  SceneEdit edit;
};

}  // namespace peerd::config
