#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collision/tree_query.hpp"
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
  std::uint64_t nodes_built = 0;
  std::uint64_t boxes_placed = 0;     // boxes of shapes taken to the world
  std::uint64_t vertices_placed = 0;  // for kBox
  QueryCounters queries;
};

struct SceneQueryOptions {
  SplitRule rule = SplitRule::kSplatter;
};

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
  explicit SceneQuery(const Scene& scene, const SceneQueryOptions& options = {});  // the scene outlives it, at its place

  // Where the Transforms are now, by their index in Scene::transforms; what is built stays. Before the first call they
  // are where the file puts them.
  void place(std::span<const TransformFields> transforms);

  // Between the shapes that collide below (or at) two objects; a Shape doesn't collide with itself. Not within an
  // object. The error names a Shape whose vertices can't be used, and where.
  [[nodiscard]] std::expected<Collision, std::string> collide(ObjectId collider, ObjectId collidee, CollisionType type);

  [[nodiscard]] SceneQueryCounters counters() const;

 private:
  struct Shaped {  // by geometry and stretch
    TriangleSoup soup;
    std::map<std::uint32_t, std::unique_ptr<KdopTree<18>>> trees;  // by splitThreshold
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
  [[nodiscard]] KdopTree<18>& tree(std::uint32_t shape, Shaped& shaped);
  [[nodiscard]] const WorldBox& box(std::uint32_t instance);
  [[nodiscard]] WorldBox shape_box(std::uint32_t shape);
  [[nodiscard]] std::expected<WorldBox, std::string> tight_box(ObjectId object);
  [[nodiscard]] bool is_surface(std::uint32_t instance) const;

  const Scene& scene_;
  SceneQueryOptions options_;
  std::vector<TransformFields> transforms_;
  std::vector<std::optional<Mesh>> meshes_;           // by geometry
  std::vector<std::optional<LocalBox>> local_boxes_;  // "
  std::map<StretchKey, std::unique_ptr<Shaped>> shaped_;
  std::vector<Placed> placed_;                  // by instance
  std::vector<std::optional<WorldBox>> boxes_;  // by instance: of its subtree, with room for all rounding
  SceneQueryCounters counters_;
};

}  // namespace peerd::collision
