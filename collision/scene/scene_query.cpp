#include "collision/scene/scene_query.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>

#include "collision/scene/shape_placement.hpp"
#include "collision/tree/hierarchy_file.hpp"

namespace peerd::collision {

struct SceneQuery::Parts {
  const Scene& scene;
  ShapePlacement placement;
  ShapeBoxes boxes;
  SceneCollide collide;
  ScenePick pick;
  SceneView view;

  Parts(const Scene& of, HierarchyLoader load_hierarchy)
      : scene(of),
        placement(of, std::move(load_hierarchy)),
        boxes(of, placement),
        collide(of, placement, boxes),
        pick(of, placement, boxes),
        view(of, placement, boxes) {}

  // Every question does this first.
  void apply_moves() {
    placement.apply_moves([&](std::uint32_t begin, std::uint32_t end) { boxes.invalidate_subtree(begin, end); });
  }
};

SceneQuery::SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy)
    : parts_(std::make_unique<Parts>(scene, std::move(load_hierarchy))) {}
SceneQuery::SceneQuery(SceneQuery&&) noexcept = default;
SceneQuery& SceneQuery::operator=(SceneQuery&&) noexcept = default;
SceneQuery::~SceneQuery() = default;

void SceneQuery::set_box_bound(BoxBound bound) { parts_->boxes.set_box_bound(bound); }

void SceneQuery::set_narrow_phase(NarrowPhase* narrow_phase) { parts_->collide.set_narrow_phase(narrow_phase); }

bool SceneQuery::move(std::uint32_t transform, const TransformFields& fields) {
  return parts_->placement.move(transform, fields);
}

void SceneQuery::set_transforms(std::span<const TransformFields> transforms) {
  assert(transforms.size() == parts_->scene.transforms.size());
  for (std::uint32_t t = 0; t < transforms.size(); ++t) move(t, transforms[t]);
}

void SceneQuery::reshape(std::uint32_t geometry, const Geometry& form) {
  parts_->placement.reshape(geometry, form);
  for (const std::uint32_t shape : instances_of_geometry(geometry)) parts_->boxes.invalidate_shape(shape);
}

std::expected<Collision, std::string> SceneQuery::collide(ObjectId collider, ObjectId collidee, CollisionType type) {
  parts_->apply_moves();
  return parts_->collide.collide(collider, collidee, type);
}

std::expected<void, std::string> SceneQuery::visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                               const std::function<bool(const ClosePair&)>& visit) {
  parts_->apply_moves();
  return parts_->collide.visit_close_pairs(collider, collidee, visit);
}

bool SceneQuery::separated_by(ObjectId a, ObjectId b, double gap_m) {
  parts_->apply_moves();
  return parts_->collide.separated_by(a, b, gap_m);
}

std::expected<std::optional<Pick>, std::string> SceneQuery::pick(const Vec3& origin_world, const Vec3& direction_world,
                                                                 double longest_m) {
  parts_->apply_moves();
  return parts_->pick.pick(origin_world, direction_world, longest_m);
}

std::expected<std::span<const ShapeInView>, std::string> SceneQuery::in_view(const Frustum& frustum, int levels) {
  parts_->apply_moves();
  return parts_->view.in_view(frustum, levels);
}

std::expected<bool, std::string> SceneQuery::may_be_in_view(ObjectId object, const Frustum& frustum) {
  parts_->apply_moves();
  return parts_->view.may_be_in_view(object, frustum);
}

const WorldBox& SceneQuery::box(ObjectId object) {
  parts_->apply_moves();
  return parts_->boxes.box(parts_->scene.index_of(object), Surfaces::kColliding);
}

double SceneQuery::displacement_m(ObjectId object) {
  parts_->apply_moves();
  const Scene& scene = parts_->scene;
  double most = 0.0;
  for (std::uint32_t i = scene.index_of(object); i < scene.at(object).subtree_end; ++i) {
    if (is_surface(scene, i, Surfaces::kColliding)) most = std::max(most, parts_->placement.displacement_m(i));
  }
  assert(most >= 0.0);
  return most;
}

std::span<const std::uint32_t> SceneQuery::instances_of_transform(std::uint32_t i) const {
  return parts_->placement.instances_of_transform(i);
}

std::span<const std::uint32_t> SceneQuery::instances_of_geometry(std::uint32_t i) const {
  return parts_->placement.instances_of_geometry(i);
}

const std::vector<std::string>& SceneQuery::notes() const { return parts_->placement.geometries().notes(); }

std::expected<std::vector<SceneQuery::Baked>, std::string> SceneQuery::bake() {
  parts_->apply_moves();
  const Scene& scene = parts_->scene;
  std::vector<Baked> files;
  std::map<std::string_view, const ScaledGeometry*> of_file;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const std::string_view url = scene.shape(scene.id_of(i)).hierarchy_file;
    if (url.empty() || !is_surface(scene, i, Surfaces::kColliding)) continue;
    const auto shape = parts_->placement.scaled_geometry(i);
    if (!shape) return std::unexpected(shape.error());
    if ((*shape)->soup.faces.empty()) continue;
    const auto [known, is_new] = of_file.try_emplace(url, *shape);
    if (!is_new && known->second != *shape) {
      return std::unexpected(scene.path_of(scene.id_of(i)) + ": hierarchyFile \"" + std::string(url) +
                             "\" is another Shape's too, of another geometry or scale");
    }
    if (!is_new) continue;
    WideTree tree((*shape)->soup);
    files.push_back({url, write_hierarchy(tree)});
  }
  return files;
}

SceneQueryCounters SceneQuery::counters() const {
  const ScaledGeometries::Counters of_geometries = parts_->placement.geometries().counters();
  SceneQueryCounters out;
  out.meshes_built = parts_->placement.meshes_built();
  out.soups_built = of_geometries.soups_built;
  out.hierarchies_built = of_geometries.hierarchies_built;
  out.hierarchies_read = of_geometries.hierarchies_read;
  out.hierarchies_refitted = of_geometries.hierarchies_refitted;
  out.nodes_built = of_geometries.nodes_built;
  out.boxes_placed = parts_->boxes.boxes_placed();
  out.vertices_placed = parts_->boxes.vertices_placed();
  out.queries = parts_->collide.counters();
  out.rays = parts_->pick.counters();
  out.views = parts_->view.counters();
  return out;
}

}  // namespace peerd::collision
