#include "core/motion/moving_scene.hpp"
#include "core/geometry/tessellate.hpp"

#include <algorithm>

namespace peerd {

MovingScene::Part::Part(const Scene& s, SceneGraph& graph, NodeHandle parent) : scene(s), motion(s) {
  std::vector<NodeSpec> specs;
  specs.reserve(s.instances.size());
  for (const Instance& i : s.instances) {
    specs.push_back({i.parent, i.transform == Instance::kNone ? nullptr : &s.transforms[i.transform]});
  }
  nodes = graph.add_subtree(parent, specs);
  for (const ObjectId id : motion.driven_transforms()) {
    for (const animation::FieldId field : motion.fields_of(id)) by_field.emplace_back(field, id);
    if (motion.drifts(id)) drifting.push_back(id);
  }
  std::ranges::sort(by_field);
}

MovingScene::MovingScene(const Scene& scene) {
  parts_.emplace_back(scene, graph_, graph_.root());
  graph_.update();
}

void MovingScene::place(Part& part, double t_s) {
  for (const ObjectId id : part.drifting) {
    graph_.set_local(part.nodes[id.value], part.motion.transform(id, t_s));
  }
  animation::Animation* const animation = part.motion.animation();
  if (animation == nullptr) return;
  if (part.placed) {
    animation->changing(std::min(time_s_, t_s), std::max(time_s_, t_s), changing_);
  } else {
    changing_.clear();
    for (const auto& [field, id] : part.by_field) changing_.push_back(field);
  }
  part.placed = true;
  for (const animation::FieldId field : changing_) {
    const auto first =
        std::ranges::lower_bound(part.by_field, field, {}, [](const auto& entry) { return entry.first; });
    for (auto it = first; it != part.by_field.end() && it->first == field; ++it) {
      graph_.set_local(part.nodes[it->second.value], part.motion.transform(it->second, t_s));
    }
  }
}

std::span<const NodeHandle> MovingScene::go_to(double t_s) {
  for (Part& part : parts_) place(part, t_s);
  time_s_ = t_s;
  return graph_.update();
}

std::vector<std::size_t> MovingScene::inlines_near(const WorldBox& of_interest) const {
  std::vector<std::size_t> near;
  const std::vector<PendingInline>& pending = parts_.front().scene.pending_inlines;
  for (std::size_t i = 0; i < pending.size(); ++i) {
    const bool filled = std::any_of(parts_.begin() + 1, parts_.end(), [&](const Part& p) { return p.pending == i; });
    if (filled) continue;
    const Eigen::Vector3f half = 0.5f * pending[i].box_size;
    const WorldBox box = transformed(world_from_local(pending[i].instance),
                                     LocalBox{pending[i].box_center - half, pending[i].box_center + half});
    const bool apart =
        (box.hi.array() < of_interest.lo.array()).any() || (box.lo.array() > of_interest.hi.array()).any();
    if (!apart) near.push_back(i);
  }
  return near;
}

void MovingScene::fill_inline(std::size_t pending, std::shared_ptr<const Scene> content) {
  const PendingInline& empty = parts_.front().scene.pending_inlines.at(pending);
  Part& part = parts_.emplace_back(*content, graph_, node(empty.instance));
  part.owned = std::move(content);
  part.pending = pending;
  place(part, time_s_);
  graph_.update();
}

void MovingScene::set_local_boxes(Part& part, std::uint32_t begin, std::uint32_t end) {
  const Scene& scene = part.scene;
  part.has_box.resize(scene.instances.size());
  part.has_geometry_box.resize(scene.geometries.size());
  part.geometry_boxes.resize(scene.geometries.size());
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t geometry = scene.instances[i].geometry;
    if (geometry == Instance::kNone || part.has_box[i]) continue;
    part.has_box[i] = true;
    if (!part.has_geometry_box[geometry]) {
      part.has_geometry_box[geometry] = true;
      part.geometry_boxes[geometry] = box_of(build_mesh(scene.geometries[geometry], scene.tessellation));
      ++meshes_built_;
    }
    if (!part.geometry_boxes[geometry].is_empty()) graph_.set_local_box(part.nodes[i], part.geometry_boxes[geometry]);
  }
}

WorldBox MovingScene::box(ObjectId id) {
  const Scene& world = parts_.front().scene;
  const std::uint32_t end = world.at(id).subtree_end;
  set_local_boxes(parts_.front(), id.value, end);
  for (auto part = parts_.begin() + 1; part != parts_.end(); ++part) {
    const ObjectId at = world.pending_inlines[part->pending].instance;
    if (at >= id && at.value < end) set_local_boxes(*part, 0, static_cast<std::uint32_t>(part->scene.instances.size()));
  }
  return graph_.box(node(id));
}

}  // namespace peerd
