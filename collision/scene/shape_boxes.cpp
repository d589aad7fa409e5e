#include "collision/scene/shape_boxes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "collision/exact/infinity.hpp"
#include "collision/tree/realigned_box.hpp"
#include "core/box.hpp"

namespace peerd::collision {
namespace {

bool finite(const WorldBox& box) { return box.is_empty() || std::isfinite(largest_coordinate(box)); }

}  // namespace

ShapeBoxes::ShapeBoxes(const Scene& scene, ShapePlacement& placement)
    : scene_(scene),
      placement_(placement),
      boxes_({std::vector<std::optional<WorldBox>>(scene.instances.size()),
              std::vector<std::optional<WorldBox>>(scene.instances.size())}) {}

void ShapeBoxes::invalidate_subtree(std::uint32_t begin, std::uint32_t end) {
  assert(begin < end && end <= scene_.instances.size());
  invalidate_upwards(begin);
  for (auto& boxes : boxes_) {
    for (std::uint32_t i = begin; i < end; ++i) boxes[i].reset();
  }
  if (!tight_boxes_.empty()) std::fill(tight_boxes_.begin() + begin, tight_boxes_.begin() + end, std::nullopt);
}

void ShapeBoxes::invalidate_shape(std::uint32_t shape) {
  invalidate_upwards(shape);
  if (!tight_boxes_.empty()) tight_boxes_[shape].reset();
  if (!dops_.empty()) dops_[shape].reset();
}

// Only the instances above that know their box: above one that doesn't, none does.
void ShapeBoxes::invalidate_upwards(std::uint32_t instance) {
  for (auto& boxes : boxes_) {
    for (auto i = static_cast<std::int32_t>(instance); i >= 0 && boxes[static_cast<std::size_t>(i)];) {
      boxes[static_cast<std::size_t>(i)].reset();
      i = scene_.instances[static_cast<std::size_t>(i)].parent;
    }
  }
}

WorldBox ShapeBoxes::shape_box(std::uint32_t shape) {
  const LocalBox& local = placement_.local_box(shape);
  const PlacedShape& placed = placement_.placed(shape);
  const Mat3& stretch = placed.pose.stretch;
  WorldBox box = transformed(placed.world_from_shape, local);
  ++boxes_placed_;
  if (box.is_empty()) return box;
  // The vertices that decide are rounded on other ways, to the other Shape's frame; all of these ways err by a few
  // units in the last place of the largest numbers on them.
  double linear = 0.0, reach = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) linear = std::max(linear, std::abs(stretch(i, j)));
    reach = std::max({reach, std::abs(static_cast<double>(local.lo[i])), std::abs(static_cast<double>(local.hi[i]))});
  }
  const double pad = 0x1p-44 * (largest_coordinate(box) + 9.0 * linear * reach);
  // A Shape whose numbers overflow must be visited and refused, not passed over.
  if (!std::isfinite(pad)) return {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
  assert(pad >= 0.0);
  for (int i = 0; i < 3; ++i) {
    box.lo[i] -= pad;
    box.hi[i] += pad;
  }
  return box;
}

// Runs from the end of the subtree to its beginning, so that no recursion is as deep as the scene.
const WorldBox& ShapeBoxes::compute(std::uint32_t instance, Surfaces which) {
  auto& boxes = boxes_[static_cast<std::size_t>(which)];
  auto& other_boxes = boxes_[1 - static_cast<std::size_t>(which)];
  for (std::uint32_t i = scene_.instances[instance].subtree_end; i-- > instance;) {
    if (boxes[i]) continue;
    WorldBox box;
    const std::uint32_t end = scene_.instances[i].subtree_end;
    if (is_surface(scene_, i, which)) {  // a Shape's box is the same for both sets
      const bool in_both =
          end == i + 1 && is_surface(scene_, i, Surfaces::kDrawn) && is_surface(scene_, i, Surfaces::kColliding);
      box = in_both && other_boxes[i] ? *other_boxes[i] : shape_box(i);
    }
    for (std::uint32_t child = i + 1; child < end; child = scene_.instances[child].subtree_end) {
      assert(boxes[child]);
      box.merge(*boxes[child]);
    }
    boxes[i] = box;
  }
  return *boxes[instance];
}

// The box of the vertices that polygons use.
WorldBox ShapeBoxes::tight_shape_box(std::uint32_t shape) {
  const Mesh& m = placement_.mesh(shape);
  const StretchedPose& at = placement_.placed(shape).pose;
  const Mat3 rotation = at.pose.orientation.toRotationMatrix();
  const bool stretched = at.stretch != Mat3::Identity();
  std::vector<bool> used(m.vertices.size());
  for (const std::int32_t corner : m.corners) {
    if (corner != Mesh::kEndOfPolygon) used[static_cast<std::size_t>(corner)] = true;
  }
  WorldBox box;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Vec3 parsed = m.vertices[v].cast<double>();
    box.merge(Vec3(multiply(rotation, stretched ? multiply(at.stretch, parsed) : parsed) + at.pose.position));
    ++vertices_placed_;
  }
  return box;
}

// The realigned box is cut to box(): broad phases compare that, and would pass over what lies beyond.
WorldBox ShapeBoxes::realigned_shape_box(std::uint32_t shape) {
  const StretchedPose& at = placement_.placed(shape).pose;
  dops_.resize(scene_.instances.size());
  std::optional<StretchedDop>& known = dops_[shape];
  if (!known || known->stretch != at.stretch) known = {at.stretch, dop_of(placement_.mesh(shape), at.stretch)};
  WorldBox out = realigned_box(known->dop, at.pose);
  if (out.is_empty()) return out;
  const WorldBox& most = box(shape, Surfaces::kColliding);
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = std::max(out.lo[k], most.lo[k]);
    out.hi[k] = std::min(out.hi[k], most.hi[k]);
  }
  return out;
}

void ShapeBoxes::set_box_bound(BoxBound bound) {
  box_bound_ = bound;
  tight_boxes_.clear();
}

std::expected<WorldBox, std::string> ShapeBoxes::tight_box(ObjectId object) {
  tight_boxes_.resize(scene_.instances.size());
  WorldBox box;
  for (std::uint32_t i = scene_.index_of(object); i < scene_.at(object).subtree_end; ++i) {
    if (!is_surface(scene_, i, Surfaces::kColliding)) continue;
    std::optional<WorldBox>& of_shape = tight_boxes_[i];
    if (!of_shape) of_shape = box_bound_ == BoxBound::kVertices ? tight_shape_box(i) : realigned_shape_box(i);
    if (!finite(*of_shape)) {
      return std::unexpected(scene_.path_of(scene_.id_of(i)) + ": its vertices have no finite place in the world");
    }
    box.merge(*of_shape);
  }
  return box;
}

}  // namespace peerd::collision
