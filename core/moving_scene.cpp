#include "core/moving_scene.hpp"

#include <algorithm>

namespace peerd {
namespace {

LocalBox box_of(const Mesh& mesh) {
  LocalBox box;
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) {
    for (const std::int32_t corner : mesh.polygon(i)) {
      const Eigen::Vector3f& v = mesh.vertices[static_cast<std::size_t>(corner)];
      box.merge(v);
    }
  }
  return box;
}

}  // namespace

MovingScene::MovingScene(const Scene& scene) : scene_(scene), motion_(scene) {
  std::vector<NodeSpec> specs;
  specs.reserve(scene.instances.size());
  for (const Instance& i : scene.instances) {
    specs.push_back({i.parent, i.transform == Instance::kNone ? nullptr : &scene.transforms[i.transform]});
  }
  nodes_ = graph_.add_subtree(graph_.root(), specs);
  for (const ObjectId id : motion_.driven_transforms()) {
    for (const animation::FieldId field : motion_.fields_of(id)) by_field_.emplace_back(field, id);
  }
  std::ranges::sort(by_field_);
  graph_.update();
}

std::span<const NodeHandle> MovingScene::go_to(double t_s) {
  if (animation::Animation* const animation = motion_.animation()) {
    if (placed_) {
      animation->changing(std::min(time_s_, t_s), std::max(time_s_, t_s), changing_);
    } else {
      changing_.clear();
      for (const auto& [field, id] : by_field_) changing_.push_back(field);
    }
    for (const animation::FieldId field : changing_) {
      const auto first = std::ranges::lower_bound(by_field_, field, {}, [](const auto& entry) { return entry.first; });
      for (auto it = first; it != by_field_.end() && it->first == field; ++it) {
        graph_.set_local(node(it->second), motion_.transform(it->second, t_s));
      }
    }
  }
  time_s_ = t_s;
  placed_ = true;
  return graph_.update();
}

void MovingScene::give_boxes(ObjectId id) {
  has_box_.resize(scene_.instances.size());
  has_geometry_box_.resize(scene_.geometries.size());
  geometry_box_.resize(scene_.geometries.size());
  for (std::uint32_t i = id.value; i < scene_.at(id).subtree_end; ++i) {
    const std::uint32_t geometry = scene_.instances[i].geometry;
    if (geometry == Instance::kNone || has_box_[i]) continue;
    has_box_[i] = true;
    if (!has_geometry_box_[geometry]) {
      has_geometry_box_[geometry] = true;
      geometry_box_[geometry] = box_of(build_mesh(scene_.geometries[geometry], scene_.tessellation));
      ++meshes_built_;
    }
    if (!geometry_box_[geometry].is_empty()) graph_.set_local_box(nodes_[i], geometry_box_[geometry]);
  }
}

WorldBox MovingScene::box(ObjectId id) {
  give_boxes(id);
  return graph_.box(node(id));
}

}  // namespace peerd
