#pragma once
#include <cstdint>
#include <optional>
#include <unordered_set>

#include "core/scene/object_finder.hpp"
#include "core/scene/path_resolver.hpp"
#include "core/scene/scene.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// An InterestReader adds the CollisionInterests and KeySensors (the thesis, C.1 and C.3) of a document to a scene whose
// instances are complete. It reports mistakes in their fields; a node with one is left out.
class InterestReader {
 public:
  InterestReader(const Document& document, Scene& scene, ObjectFinder& objects, Problems& problems)
      : document_(document), scene_(scene), objects_(objects), problems_(problems) {}

  // Notes the KeySensors that have a ROUTE, and reports ROUTEs between KeySensors and other nodes. It is called before
  // any KeySensor is added.
  void check_key_routes();
  void add_interest(std::uint32_t node);
  // The same where its ends are known.
  void add_bound_interest(std::uint32_t node, const CollisionInterest& interest);
  void add_key_sensor(std::uint32_t node);
  // The same where the recipient is known.
  void add_bound_key_sensor(std::uint32_t node, std::optional<ObjectId> recipient);

 private:
  // Reports what is no type, and returns it.
  [[nodiscard]] CollisionType type_of(const Node& node);
  // Returns the instance of a path; adds it to the patterns where it is one.
  [[nodiscard]] std::optional<ObjectId> add_end(InterestSide& side, std::string_view path, std::uint32_t scope,
                                                Position at);
  // Adds what a field names. To name one of `others` is an error; `what_they_are` says why.
  void add_ends(InterestSide& side, const Node& node, std::string_view field, const InterestSide& others,
                std::string_view what_they_are);

  const Document& document_;
  Scene& scene_;
  ObjectFinder& objects_;
  Problems& problems_;
  PathResolver paths_{scene_};
  std::unordered_set<std::uint32_t> routed_keys_;  // KeySensors whose events go to others
};

}  // namespace peerd::vrml
