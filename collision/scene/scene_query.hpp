#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collision/query/ray_query.hpp"
#include "collision/query/view_query.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/tree/kdop.hpp"
#include "core/scene/scene.hpp"

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

// What a ray hits first.
struct Pick {
  ShapePolygon at;
  double distance_m = 0.0;          // from the origin, rounded
  Vec3 point_world = Vec3::Zero();  // origin + t * direction, rounded
  // Unit, of the triangle that was hit, to the side from which the ray comes; zero where the triangle has no area, as
  // rounded, or the ray is in its plane.
  Vec3 normal_world = Vec3::Zero();
};

struct ShapeInView {
  ObjectId shape;
  bool wholly = false;  // certainly inside; else it may be in view
  friend auto operator<=>(const ShapeInView&, const ShapeInView&) = default;
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
  RayCounters rays;
  ViewCounters views;
};

// A file in memory, at an address that is a multiple of 32.
struct MappedFile {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
};
// The file of a Shape's hierarchyFile; nothing where there is no such file; or why it can't be read, in a few words.
using HierarchyLoader = std::function<std::expected<std::optional<MappedFile>, std::string>(std::string_view url)>;

enum class BoxBound : std::uint8_t {
  kVertices,   // the boxes of the vertices
  kRealigned,  // the seed's (realigned_box.hpp), but no larger than box(): of no vertex's cost once a form was seen
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
  // Without a loader hierarchyFile is not looked at.
  explicit SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy = {});  // the scene outlives it, at its place

  // What kBox compares from now on.
  void set_box_bound(BoxBound bound);

  // Where a Transform is from now on, by its index in Scene::transforms; before, it is where the file puts it. Costs
  // what is below it, when a question comes to that. What is built stays, but for forms that a scale made and no Shape
  // has any more. False, and nothing is done, where it is there already.
  bool move(std::uint32_t transform, const TransformFields& fields);
  void set_transforms(std::span<const TransformFields> transforms);  // all; those that differ are moved

  // A geometry has another form from now on: flexible objects (the seed's 3.2.1), such as what a CoordinateInterpolator
  // moves. Where only vertices moved, hierarchies are refitted, as deep as they are; a witness that they find may then
  // be another one than a new hierarchy finds.
  void reshape(std::uint32_t geometry, const Geometry& form);

  // Between the shapes that collide below (or at) two objects; a Shape doesn't collide with itself. Not within an
  // object. The error names a Shape whose vertices can't be used, and where.
  [[nodiscard]] std::expected<Collision, std::string> collide(ObjectId collider, ObjectId collidee, CollisionType type);

  // The nearest polygon of the Shapes that are drawn, whether they collide or not: what is seen can be picked, and a
  // proxy can't. The direction's length is of no concern. Nothing: no Shape is hit within `longest_m`.
  //
  // The ray is taken to each Shape's frame, transpose(rotation) * (origin - position) and transpose(rotation) *
  // direction, rounded there; of the real ray of those numbers a hit is exact (ray_query.hpp). The parameters of
  // different Shapes are compared as they are rounded, equal ones by the Shape's id, then the polygon's number. So no
  // ray slips through a Shape that is closed; between two that only touch one may.
  //
  // Shapes are asked in the order in which the ray enters their boxes, until one is entered behind the nearest hit:
  // what isn't asked isn't triangulated, and its hierarchy isn't built. The error names a Shape that was asked and
  // can't be used, or says what is wrong with the ray.
  [[nodiscard]] std::expected<std::optional<Pick>, std::string> pick(
      const Vec3& origin_world, const Vec3& direction_world,
      double longest_m = std::numeric_limits<double>::infinity());

  // The Shapes that are drawn and may be in view, in the scene's order, by the boxes of subtrees; valid until the next
  // call. None that has a point in the frustum is left out. With `levels` above 0 a Shape whose box crosses the
  // frustum's border is looked at by its hierarchy, to so many levels; without, nothing but boxes is made. The error
  // names a Shape that was looked at and can't be used.
  [[nodiscard]] std::expected<std::span<const ShapeInView>, std::string> in_view(const Frustum& frustum,
                                                                                 int levels = 0);
  // Whether any polygon that is drawn below (or at) an object may be in view; false is certain. To the last triangle.
  [[nodiscard]] std::expected<bool, std::string> may_be_in_view(ObjectId object, const Frustum& frustum);

  // A box of all that can collide below an object, with room for all rounding: objects whose boxes are apart don't
  // collide, in any of the three ways. Valid until something moves.
  [[nodiscard]] const WorldBox& box(ObjectId object) {
    apply_moves();
    return box(object.value);
  }
  // How far what can collide below an object has gone from where it was when its box was asked for before [m]: no point
  // farther, all rounding included. Only of what moved since the last question but these; reshaped ones don't count.
  [[nodiscard]] double displacement_m(ObjectId object);
  // Whether what can collide below two objects is certainly farther apart than that [m]; see WideQuery::separated_by().
  [[nodiscard]] bool separated_by(ObjectId a, ObjectId b, double gap_m);

  // Two Shapes whose boxes overlap, as the exact questions see them.
  struct ClosePair {
    std::uint32_t a = 0, b = 0;                  // instances, a < b: a gives the frame
    std::uint64_t version_a = 0, version_b = 0;  // another number, never used before, whenever the vertices are others
    WideTree *tree_a = nullptr, *tree_b = nullptr;
    RelativeMotion a_from_b;
    bool collider_first = true;  // a is below the collider
  };
  // Those below two objects, in the order in which collide() looks for a witness, until `visit` says true. The error is
  // collide()'s.
  [[nodiscard]] std::expected<void, std::string> visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                                   const std::function<bool(const ClosePair&)>& visit);

  // The instances that have a Transform, or a geometry: several where it is USEd.
  [[nodiscard]] std::span<const std::uint32_t> instances_of_transform(std::uint32_t i) const {
    return instances_of_transform_.of(i);
  }
  [[nodiscard]] std::span<const std::uint32_t> instances_of_geometry(std::uint32_t i) const {
    return instances_of_geometry_.of(i);
  }

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
  [[nodiscard]] std::size_t forms() const {
    return scaled_geometries_.size();
  }  // that are kept: geometries, each as it is scaled

 private:
  struct StretchKey {
    std::uint32_t geometry = 0;
    std::array<double, 9> stretch{};
    friend auto operator<=>(const StretchKey&, const StretchKey&) = default;
  };
  struct ScaledGeometry {  // by geometry and stretch
    StretchKey key;
    std::uint64_t version = 0;
    TriangleSoup soup;
    std::optional<WideTree> tree{};
    std::size_t use_count = 0;  // instances that were asked about
  };
  // Of a placed instance: what is known of it now.
  struct Placed {
    bool known = false;  // `at` and what follows from it
    bool had_pose = false;
    StretchedPose at;
    Affine world_from_shape;
    double displacement_m = 0.0;                // to there from where it was before
    std::uint64_t updated_at = 0;               // when that was
    ScaledGeometry* scaled_geometry = nullptr;  // of that stretch
  };
  // The instances that have each of a number of things, in order.
  class InstanceIndex {
   public:
    InstanceIndex(const Scene& scene, std::uint32_t Instance::*member, std::size_t count);
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t member) const {
      return std::span(instances_).subspan(begin_[member], begin_[member + 1] - begin_[member]);
    }

   private:
    std::vector<std::uint32_t> begin_, instances_;
  };
  struct Search;
  enum class Surfaces : std::uint8_t { kColliding, kDrawn };

  void apply_moves();
  void invalidate_box(std::uint32_t instance);
  void erase_scaled_geometry(std::map<StretchKey, std::unique_ptr<ScaledGeometry>>::iterator scaled_geometry);
  [[nodiscard]] const Mesh& mesh(std::uint32_t geometry);
  [[nodiscard]] const LocalBox& local_box(std::uint32_t geometry);
  [[nodiscard]] const Placed& placed(std::uint32_t shape);
  [[nodiscard]] std::expected<ScaledGeometry*, std::string> scaled_geometry(std::uint32_t shape);
  [[nodiscard]] WideTree& tree(std::uint32_t shape, ScaledGeometry& scaled_geometry);
  [[nodiscard]] std::optional<WideTree> read_tree(std::uint32_t shape, const TriangleSoup& soup);
  [[nodiscard]] const WorldBox& box(std::uint32_t instance, Surfaces which = Surfaces::kColliding);
  [[nodiscard]] WorldBox shape_box(std::uint32_t shape);
  [[nodiscard]] std::expected<WorldBox, std::string> tight_box(ObjectId object);
  [[nodiscard]] WorldBox tight_shape_box(std::uint32_t shape);
  [[nodiscard]] WorldBox realigned_shape_box(std::uint32_t shape);
  [[nodiscard]] bool is_surface(std::uint32_t instance, Surfaces which = Surfaces::kColliding) const;
  [[nodiscard]] std::expected<void, std::string> pick_shape(std::uint32_t shape, const Ray& world);
  void push_if_hit(std::uint32_t instance, const Ray& world);
  [[nodiscard]] std::expected<bool, std::string> shape_in_view(std::uint32_t shape, const Frustum& frustum,
                                                               PlaneMask active, int levels);
  // found(shape, planes that its box is not certainly inside of) -> whether that was all, for each that may be in view.
  template <class Found>
  void cull_subtrees(std::uint32_t begin, std::uint32_t end, const Frustum& frustum, Found found);

  const Scene& scene_;
  HierarchyLoader load_hierarchy_;
  std::vector<std::string> notes_;
  std::vector<TransformFields> transforms_;
  InstanceIndex instances_of_transform_, instances_of_geometry_;  // by transform, by geometry
  std::vector<std::uint32_t> moved_;                  // instances whose Transform has moved since the last question
  std::vector<std::optional<Mesh>> meshes_;           // by geometry
  std::vector<std::optional<LocalBox>> local_boxes_;  // ", of all vertices: fewer than there are corners
  std::map<StretchKey, std::unique_ptr<ScaledGeometry>> scaled_geometries_;
  std::vector<Placed> placed_;  // by instance
  // By Surfaces and instance: of its subtree, with room for all rounding. Where one is known, all below it are.
  std::array<std::vector<std::optional<WorldBox>>, 2> boxes_;
  std::vector<std::optional<WorldBox>> tight_boxes_;  // of an instance's own vertices; empty before kBox is asked
  BoxBound box_bound_ = BoxBound::kVertices;
  // By instance, for kRealigned: of its form with that stretch.
  struct StretchedDop {
    Mat3 stretch;
    Kdop<18> dop;
  };
  std::vector<std::optional<StretchedDop>> dops_;
  std::vector<TransformFields> path_;  // scratch
  std::uint64_t next_version_ = 0, move_batch_ = 0;
  WideQuery query_;
  RayQuery rays_;
  ViewQuery views_;
  struct Entry {
    double t = 0.0;  // no later than where the ray enters the box
    std::uint32_t instance = 0;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };
  std::vector<Entry> entries_;  // of pick(): a heap, the first entered on top
  struct Picked {
    double t = 0.0;
    std::uint32_t shape = 0;
    RayHit hit;
  };
  std::optional<Picked> picked_;  // so far
  struct OpenSubtree {
    std::uint32_t end = 0;
    PlaneMask active = 0;
  };
  std::vector<OpenSubtree> open_;  // of look()
  std::vector<ShapeInView> in_view_;
  SceneQueryCounters counters_;
};

}  // namespace peerd::collision
