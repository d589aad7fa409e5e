#include "collision/scene/shape_placement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace peerd::collision {
namespace {

// No point of the box goes farther than this [m]. The difference of two affine maps is one, so its length is greatest
// at a corner. The rounding of all this is some 2^-50 of `reach`, and so is that of the vertices that decide.
double displacement_bound_m(const Affine& from, const Affine& to, const LocalBox& box) {
  if (box.is_empty()) return 0.0;
  Vec3 middle = to.offset - from.offset, aside[3];
  double reach = to.offset.cwiseAbs().maxCoeff() + from.offset.cwiseAbs().maxCoeff();
  for (int i = 0; i < 3; ++i) {
    const Vec3 turned = to.linear.col(i) - from.linear.col(i);
    const double lo = box.lo[i], hi = box.hi[i];
    middle += turned * (0.5 * (lo + hi));
    aside[i] = turned * (0.5 * (hi - lo));
    const double linear = to.linear.col(i).cwiseAbs().maxCoeff() + from.linear.col(i).cwiseAbs().maxCoeff();
    reach += 9.0 * linear * std::max(std::abs(lo), std::abs(hi));
  }
  double most = 0.0;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vec3 edge = middle + x * aside[0] + y * aside[1];
      most = std::max({most, (edge + aside[2]).squaredNorm(), (edge - aside[2]).squaredNorm()});
    }
  }
  return std::sqrt(most) * (1.0 + 0x1p-48) + 0x1p-41 * reach;
}

bool equal(const TransformFields& a, const TransformFields& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs() && a.scale == b.scale &&
         a.scale_orientation.coeffs() == b.scale_orientation.coeffs() && a.center == b.center;
}

}  // namespace

ShapePlacement::ShapePlacement(const Scene& scene, HierarchyLoader load_hierarchy)
    : scene_(scene),
      meshes_(scene),
      geometries_(scene, std::move(load_hierarchy)),
      instances_of_transform_(scene, &Instance::transform, scene.transforms.size()),
      instances_of_geometry_(scene, &Instance::geometry, scene.geometries.size()),
      transforms_(scene.transforms),
      placed_(scene.instances.size()) {}

bool ShapePlacement::move(std::uint32_t transform, const TransformFields& fields) {
  assert(transform < transforms_.size());
  if (equal(transforms_[transform], fields)) return false;
  transforms_[transform] = fields;
  const auto moved = instances_of_transform_.of(transform);
  moved_.insert(moved_.end(), moved.begin(), moved.end());
  return true;
}

// In ascending order, what is below something that moved comes right behind it, and is passed over once, however much
// of it has moved as well.
void ShapePlacement::begin_batch() {
  ++batch_;
  std::ranges::sort(moved_);
}

void ShapePlacement::reshape(std::uint32_t geometry, const Geometry& form) {
  meshes_.reshape(geometry, form);
  geometries_.reshape(geometry, meshes_.mesh(geometry), [&](const ScaledGeometry& dropped) {
    for (const std::uint32_t i : instances_of_geometry_.of(geometry)) {
      if (placed_[i].scaled_geometry == &dropped) placed_[i].scaled_geometry = nullptr;
    }
  });
}

const PlacedShape& ShapePlacement::placed(std::uint32_t shape) {
  assert(shape < placed_.size());
  PlacedShape& at = placed_[shape];
  if (at.known) return at;
  path_.clear();
  for (auto i = static_cast<std::int32_t>(shape); i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    const std::uint32_t t = scene_.instances[static_cast<std::size_t>(i)].transform;
    if (t != Instance::kNone) path_.push_back(transforms_[t]);
  }
  std::ranges::reverse(path_);
  const StretchedPose now = stretched_pose(path_);
  if (at.scaled_geometry != nullptr && now.stretch != at.pose.stretch) {
    geometries_.release(*at.scaled_geometry);
    at.scaled_geometry = nullptr;
  }
  const Affine from = at.world_from_shape;
  at.pose = now;
  at.world_from_shape = {multiply(now.pose.orientation.toRotationMatrix(), now.stretch), now.pose.position};
  at.updated_batch = batch_;
  if (std::exchange(at.had_pose, true)) {
    at.displacement_m = displacement_bound_m(from, at.world_from_shape, local_box(shape));
  }
  at.known = true;
  return at;
}

std::expected<ScaledGeometry*, std::string> ShapePlacement::scaled_geometry(std::uint32_t shape) {
  const Mat3& stretch = placed(shape).pose.stretch;
  PlacedShape& at = placed_[shape];
  if (at.scaled_geometry != nullptr) return at.scaled_geometry;
  const auto acquired = geometries_.acquire(geometry_of(shape), stretch, meshes_);
  if (!acquired) return std::unexpected(scene_.path_of(scene_.id_of(shape)) + ": " + acquired.error());
  at.scaled_geometry = *acquired;
  assert(at.scaled_geometry->key.geometry == geometry_of(shape) && at.scaled_geometry->use_count > 0);
  return at.scaled_geometry;
}

}  // namespace peerd::collision
