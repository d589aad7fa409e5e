#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/edit/document_editor.hpp"
#include "core/scene/reader.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/scene_builder.hpp"
#include "core/transform.hpp"

namespace peerd {

// The place of a node among others: as a child of `parent` (none: at the top level), in front of `before` (none: behind
// all).
struct ScenePlace {
  std::optional<ObjectId> parent;
  std::optional<ObjectId> before;
};

// A SceneEditor makes a scene of another one and of changes to it. What comes out is what reading a file would give
// that has the changes in it, but that all that was there keeps its ids, and what a CollisionInterest or a KeySensor
// names stays what it was when it came, whatever its path has become.
//
// A change that is refused changes nothing; the error says why, for people. Nodes inside of something that is USEd
// several times cannot be moved, removed or added to, because they are in several places at once; their fields can be
// set, in all of these places.
class SceneEditor {
 public:
  explicit SceneEditor(const Scene& scene);  // the scene outlives the editor, at its place

  // What the nodes of a text are to be called: their ids count on from these, and nothing has had them before.
  struct FirstIds {
    ObjectId object;
    NodeId node;
  };
  struct Added {
    std::uint32_t objects = 0, nodes = 0;  // ids that the text has used
  };
  // Adds all that a VRML text has. `find` says what paths in it mean that name nothing in it. `options` are those of
  // the world.
  [[nodiscard]] std::expected<Added, std::string> add(
      std::string_view text, const ScenePlace& place, const FirstIds& first, const ReadOptions& options,
      const std::function<std::optional<ObjectId>(std::string_view)>& find = {});
  // The instance and those below it, and the nodes of all that is below it, ascending; none: it is not there.
  struct Below {
    std::vector<ObjectId> objects;
    std::vector<NodeId> nodes;
  };
  [[nodiscard]] Below below(ObjectId id) const;
  // Whether the one is the other, or stands anywhere below it. False where one of them is not there.
  [[nodiscard]] bool is_within(ObjectId id, ObjectId above) const;
  // Removes an instance with all below it; ROUTEs and interests that lead to it go with it.
  [[nodiscard]] std::expected<void, std::string> remove(ObjectId id);
  // Removes a node that is no instance, such as a CollisionInterest or a TimeSensor, wherever it stands.
  [[nodiscard]] std::expected<void, std::string> remove(NodeId id);
  // Moves an instance with all below it; its fields stay, so that it moves in the world where its parents differ.
  [[nodiscard]] std::expected<void, std::string> move(ObjectId id, const ScenePlace& place);
  // Sets where an instance, a Transform, stands in its parent.
  [[nodiscard]] std::expected<void, std::string> set_placement(ObjectId id, const Placement& placement);
  // Sets a field to a value in the notation of VRML: "1 2 3", "[ 0, 1 ]", "Box { size 1 1 1 }". The ids of nodes in the
  // value count on from `first`; returns how many it has used.
  [[nodiscard]] std::expected<std::uint32_t, std::string> set(NodeId id, std::string_view field, std::string_view value,
                                                              NodeId first);
  [[nodiscard]] std::expected<void, std::string> add_route(NodeId from, std::string_view event_out, NodeId to,
                                                           std::string_view event_in);
  [[nodiscard]] std::expected<void, std::string> remove_route(NodeId from, std::string_view event_out, NodeId to,
                                                              std::string_view event_in);

  [[nodiscard]] bool contains(ObjectId id) const { return draft_of(id).has_value(); }
  [[nodiscard]] bool contains(NodeId id) { return node_of(id).has_value(); }
  // Returns whether finish() may fail: only there it is known whether the nodes of a geometry or of a CollisionResponse
  // go together. All other changes are checked when they are made.
  [[nodiscard]] bool may_fail() const { return may_fail_; }
  // Returns the scene; the error says what the changes together make impossible. The editor is not used any more. One
  // editor for each change would make the same scene, and refuse the same, but for what it finds impossible here.
  [[nodiscard]] std::expected<Scene, std::string> finish();

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct Draft {  // an instance
    ObjectId id;
    std::uint32_t node = kNone;  // in document_
    std::uint32_t parent = kNone;
    std::vector<std::uint32_t> children;  // in order
    bool removed = false;
  };
  struct Spot {  // among the children of a draft, and in the list of its node
    std::vector<std::uint32_t>* drafts = nullptr;
    std::vector<vrml::NodeRef>* refs = nullptr;
    std::size_t draft = 0, ref = 0;
  };

  [[nodiscard]] std::optional<std::uint32_t> draft_of(ObjectId id) const;
  [[nodiscard]] std::optional<std::uint32_t> node_of(NodeId id);
  // Nothing may lead to some node any more.
  void note_dropped() {
    has_dropped_ = true;
    reached_.reset();
  }
  [[nodiscard]] std::expected<Spot, std::string> spot_at(const ScenePlace& place);
  [[nodiscard]] std::expected<Spot, std::string> spot_of(std::uint32_t draft);
  [[nodiscard]] std::expected<Spot, std::string> children_of(std::optional<std::uint32_t> parent);
  [[nodiscard]] std::expected<vrml::Route, std::string> route(NodeId from, std::string_view event_out, NodeId to,
                                                              std::string_view event_in);
  [[nodiscard]] std::uint32_t depth_of(std::optional<std::uint32_t> draft) const;
  [[nodiscard]] std::uint32_t height_of(std::uint32_t draft) const;
  void mark_removed(std::uint32_t draft);
  void add_drafts(const Scene& content, std::uint32_t first_node, std::optional<std::uint32_t> parent,
                  const Spot& spot);
  void drop_interests_without_ends();
  [[nodiscard]] vrml::Bindings bindings(const std::vector<std::uint32_t>& place) const;
  void rewrite_paths(const Scene& scene, vrml::Document& document) const;

  const Scene& scene_;
  vrml::DocumentEditor document_;
  std::vector<Draft> drafts_;  // those of the scene keep their index
  std::vector<std::uint32_t> top_level_;
  std::unordered_map<ObjectId, std::uint32_t> added_objects_;
  std::unordered_map<NodeId, std::uint32_t> added_nodes_;
  std::size_t live_ = 0;  // drafts that are not removed
  bool may_fail_ = false;
  bool has_dropped_ = false;                              // nodes, by some change
  std::optional<std::vector<bool>> reached_;              // by node, of those that were there then; none: not known
  std::vector<std::uint32_t> instances_of_;               // by node: how many there are
  std::map<std::uint32_t, CollisionInterest> interests_;  // by node
  std::map<std::uint32_t, std::optional<ObjectId>> recipients_;  // by node
};

}  // namespace peerd
