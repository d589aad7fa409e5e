#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collision/wide_query.hpp"
#include "core/scene.hpp"

namespace peerd::collision {

struct ShapePolygon {
  ObjectId shape;
  std::uint32_t polygon = 0;  // in file order
  friend auto operator<=>(const ShapePolygon&, const ShapePolygon&) = default;
};

struct ShapePair {
  ShapePolygon collider, collidee;
  friend auto operator<=>(const ShapePair&, const ShapePair&) = default;
};

struct Collision {
  bool colliding = false;
  std::vector<ShapePair> pairs;  // kWitness: one; kAllPairs: all, sorted, each once; kBox: none
};

// Work done, since the beginning.
struct SceneQueryCounters {
  std::uint64_t meshes_built = 0;       // geometries tessellated
  std::uint64_t soups_built = 0;        // triangulated
  std::uint64_t hierarchies_built = 0;  // begun: how far says nodes_built
  std::uint64_t hierarchies_read = 0;   // from their files
  std::uint64_t hierarchies_refitted = 0;
  std::uint64_t nodes_built = 0;
  std::uint64_t boxes_placed = 0;     // boxes of shapes taken to the world
  std::uint64_t vertices_placed = 0;  // for kBox
  QueryCounters queries;
};

// A file in memory, at an address that is a multiple of 32.
struct MappedFile {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
};
// The file of a Shape's hierarchyFile; nothing where there is no such file; or why it can't be read, in a few words.
using HierarchyLoader = std::function<std::expected<std::optional<MappedFile>, std::string>(std::string_view url)>;

// Which of a scene's objects collide, at one time. Nothing is built that no question needs: kBox reads vertices only;
// polygons are triangulated when the boxes of two shapes overlap, and a hierarchy is built as deep as it is visited.
// One mesh, soup and hierarchy serve all instances that have the same geometry, stretch and splitThreshold.
//
// The answers are exact in this sense: a Shape's vertices are its geometry's as parsed, or, where its path is scaled,
// as baked by make_soup(); of two Shapes the one with the lower id gives the frame, to which RelativeMotion takes the
// other's vertices; there, the closed triangles' real points decide. kBox compares the closed boxes of the vertices as
// each Shape's pose takes them to the world, multiply(rotation, vertex) + position.
class SceneQuery {
 public:
  // Without a loader hierarchyFile is not looked at.
  explicit SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy = {});  // the scene outlives it, at its place

  // Where the Transforms are now, by their index in Scene::transforms; what is built stays. Before the first call they
  // are where the file puts them.
  void place(std::span<const TransformFields> transforms);

  // A geometry has another form from now on: flexible objects (the seed's 3.2.1), such as what a CoordinateInterpolator
  // moves. Where only vertices moved, hierarchies are refitted, as deep as they are.
  void reshape(std::uint32_t geometry, const Geometry& form);

  // Between the shapes that collide below (or at) two objects; a Shape doesn't collide with itself. Not within an
  // object. The error names a Shape whose vertices can't be used, and where.
  [[nodiscard]] std::expected<Collision, std::string> collide(ObjectId collider, ObjectId collidee, CollisionType type);

  // The hierarchies of the Shapes below an object that collide and name a hierarchyFile, each file once: its URL and
  // what belongs in it.
  struct Baked {
    std::string_view url;
    std::string bytes;
  };
  [[nodiscard]] std::expected<std::vector<Baked>, std::string> bake();

  // hierarchyFiles that were refused, each with its Shape and the reason; their hierarchies were built instead.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] SceneQueryCounters counters() const;

 private:
  struct Shaped {  // by geometry and stretch
    TriangleSoup soup;
    std::optional<WideTree> tree{};
  };
  struct StretchKey {
    std::uint32_t geometry = 0;
    std::array<double, 9> stretch{};
    friend auto operator<=>(const StretchKey&, const StretchKey&) = default;
  };
  // Of a placed instance: what is known of it now.
  struct Placed {
    bool known = false;
    StretchedPose at;
    Shaped* shaped = nullptr;
  };
  struct Search;

  [[nodiscard]] const Mesh& mesh(std::uint32_t geometry);
  [[nodiscard]] const LocalBox& local_box(std::uint32_t geometry);
  [[nodiscard]] const StretchedPose& placed(std::uint32_t shape);
  [[nodiscard]] std::expected<Shaped*, std::string> shaped(std::uint32_t shape);
  [[nodiscard]] WideTree& tree(std::uint32_t shape, Shaped& shaped);
  [[nodiscard]] std::optional<WideTree> read_tree(std::uint32_t shape, const TriangleSoup& soup);
  [[nodiscard]] const WorldBox& box(std::uint32_t instance);
  [[nodiscard]] WorldBox shape_box(std::uint32_t shape);
  [[nodiscard]] std::expected<WorldBox, std::string> tight_box(ObjectId object);
  [[nodiscard]] bool is_surface(std::uint32_t instance) const;

  const Scene& scene_;
  HierarchyLoader load_hierarchy_;
  std::vector<std::string> notes_;
  std::vector<TransformFields> transforms_;
  std::vector<std::optional<Mesh>> meshes_;           // by geometry
  std::vector<std::optional<LocalBox>> local_boxes_;  // ", of all vertices: fewer than there are corners
  std::map<StretchKey, std::unique_ptr<Shaped>> shaped_;
  std::vector<Placed> placed_;                  // by instance
  std::vector<std::optional<WorldBox>> boxes_;  // by instance: of its subtree, with room for all rounding
  WideQuery query_;
  SceneQueryCounters counters_;
};

}  // namespace peerd::collision
