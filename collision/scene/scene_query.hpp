#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collision/scene/scene_collide.hpp"
#include "collision/scene/scene_pick.hpp"
#include "collision/scene/scene_view.hpp"
#include "collision/scene/shape_boxes.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// Work done since the beginning.
struct SceneQueryCounters {
  std::uint64_t meshes_built = 0;          // geometries tessellated
  std::uint64_t soups_built = 0;           // geometries triangulated
  std::uint64_t hierarchies_built = 0;     // hierarchies begun; nodes_built says how far
  std::uint64_t hierarchies_read = 0;      // hierarchies taken from their files
  std::uint64_t hierarchies_refitted = 0;  // hierarchies that followed moved vertices
  std::uint64_t nodes_built = 0;
  std::uint64_t boxes_placed = 0;     // boxes of Shapes taken to the world
  std::uint64_t vertices_placed = 0;  // vertices taken to the world for kBox
  QueryCounters queries;
  RayCounters rays;
  ViewCounters views;
};

// Answers which of a scene's objects collide, are hit by a ray, or are in view, at one time. Nothing is built that no
// question needs: kBox reads vertices only; polygons are triangulated when the boxes of two Shapes overlap, and a
// hierarchy is built as deep as it is visited. One mesh, soup and hierarchy serve all instances that have the same
// geometry, stretch and splitThreshold.
//
// The answers are exact in this sense: a Shape's vertices are its geometry's as parsed, or, where its path is scaled,
// as baked by make_soup(); of two Shapes the one with the lower id gives the frame, to which RelativeMotion takes the
// other's vertices; there, the closed triangles' real points decide. kBox compares the closed boxes of the vertices as
// each Shape's pose takes them to the world, multiply(rotation, vertex) + position.
//
// This class is a facade: ShapePlacement knows where Shapes are, ShapeBoxes bounds them, and SceneCollide, ScenePick
// and SceneView answer. Not thread-safe.
class SceneQuery {
 public:
  // Without a loader no hierarchyFile is read. The scene outlives this object, at its place.
  explicit SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy = {});
  SceneQuery(SceneQuery&&) noexcept;
  SceneQuery& operator=(SceneQuery&&) noexcept;
  ~SceneQuery();

  // Sets what kBox compares from now on.
  void set_box_bound(BoxBound bound);

  // Lets another way answer about pairs of Shapes from now on (collision/engines); null: ours. It outlives this
  // object.
  void set_narrow_phase(NarrowPhase* narrow_phase);

  // Sets where a Transform is from now on, by its index in Scene::transforms; before, it is where the file puts it. The
  // cost is that of the subtree below it, when a question comes to that. What is built stays, but for scaled geometries
  // that no Shape has any more. False, and nothing is done, where the Transform is there already.
  bool move(std::uint32_t transform, const TransformFields& fields);
  void set_transforms(std::span<const TransformFields> transforms);  // all Transforms; those that differ are moved

  // Gives a geometry another form from now on: flexible objects (thesis, 3.2.1), such as what a CoordinateInterpolator
  // moves. Where only vertices moved, hierarchies are refitted, as deep as they are; a witness that they find may then
  // be another one than a new hierarchy finds.
  void reshape(std::uint32_t geometry, const Geometry& form);

  // Tests the Shapes that collide below (or at) one object against those of another; a Shape doesn't collide with
  // itself. Nothing is tested within an object. The error names a Shape whose vertices can't be used, and where.
  [[nodiscard]] std::expected<Collision, std::string> collide(ObjectId collider, ObjectId collidee, CollisionType type);

  // Finds the nearest polygon of the Shapes that are drawn, whether they collide or not: what is seen can be picked,
  // and a proxy can't. The direction's length doesn't matter. Nothing is returned where no Shape is hit within
  // `longest_m`.
  //
  // The ray is taken to each Shape's frame, transpose(rotation) * (origin - position) and transpose(rotation) *
  // direction, rounded there; a hit is exact for the real ray of those numbers (ray_query.hpp). The parameters of
  // different Shapes are compared as they are rounded, equal ones by the Shape's id, then the polygon's number. So no
  // ray slips through a Shape that is closed; between two that only touch one may.
  //
  // Shapes are tested in the order in which the ray enters their boxes, until one is entered behind the nearest hit: a
  // Shape that isn't tested isn't triangulated, and its hierarchy isn't built. The error names a Shape that was tested
  // and can't be used, or says what is wrong with the ray.
  [[nodiscard]] std::expected<std::optional<Pick>, std::string> pick(
      const Vec3& origin_world, const Vec3& direction_world,
      double longest_m = std::numeric_limits<double>::infinity());

  // Finds the Shapes that are drawn and may be in view, in the scene's order, by the boxes of subtrees; valid until the
  // next call. None that has a point in the frustum is left out. With `levels` above 0 a Shape whose box crosses the
  // frustum's border is tested by that many levels of its hierarchy; with 0 nothing but boxes is made. The error names
  // a Shape that was tested and can't be used.
  [[nodiscard]] std::expected<std::span<const ShapeInView>, std::string> in_view(const Frustum& frustum,
                                                                                 int levels = 0);
  // Whether any polygon that is drawn below (or at) an object may be in view, tested to the last triangle; false is
  // certain.
  [[nodiscard]] std::expected<bool, std::string> may_be_in_view(ObjectId object, const Frustum& frustum);

  // A box of all that can collide below an object, with room for all rounding: objects whose boxes are apart don't
  // collide, in any of the three ways. Valid until something moves.
  [[nodiscard]] const WorldBox& box(ObjectId object);
  // A bound of how far any point that can collide below an object has gone [m], all rounding included, from where it
  // was when the object's box was last computed. It covers what moved since the last question but these; reshaped
  // geometries don't count.
  [[nodiscard]] double displacement_m(ObjectId object);
  // Whether all that can collide below two objects is certainly farther apart than `gap_m` >= 0; see
  // WideQuery::separated_by().
  [[nodiscard]] bool separated_by(ObjectId a, ObjectId b, double gap_m);

  using ClosePair = collision::ClosePair;
  // Visits the close pairs of Shapes below two objects, in the order in which collide() searches a witness, until
  // `visit` returns true. The error is collide()'s.
  [[nodiscard]] std::expected<void, std::string> visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                                   const std::function<bool(const ClosePair&)>& visit);

  // The instances that have a Transform, or a geometry: several where it is USEd.
  [[nodiscard]] std::span<const std::uint32_t> instances_of_transform(std::uint32_t i) const;
  [[nodiscard]] std::span<const std::uint32_t> instances_of_geometry(std::uint32_t i) const;

  // The content of a hierarchyFile.
  struct Baked {
    std::string_view url;
    std::string bytes;
  };
  // Builds the hierarchies of the Shapes that collide and name a hierarchyFile, each file once. The error names a Shape
  // that can't be used, or whose file another Shape needs for something else.
  [[nodiscard]] std::expected<std::vector<Baked>, std::string> bake();

  // The hierarchyFiles that were refused, each with its Shape and the reason; their hierarchies were built instead.
  [[nodiscard]] const std::vector<std::string>& notes() const;
  [[nodiscard]] SceneQueryCounters counters() const;

 private:
  struct Parts;  // at one place, since they refer to each other
  std::unique_ptr<Parts> parts_;
};

}  // namespace peerd::collision
