#include "collision/scene/scene_view.hpp"

#include <cassert>

namespace peerd::collision {

SceneView::SceneView(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes)
    : scene_(scene), placement_(placement), boxes_(boxes) {}

// Calls found(shape, planes that its box is not certainly inside of) for each Shape that may be in view, in the scene's
// order, until it answers true. Subtrees that are outside are skipped, and a plane that a subtree's box is wholly
// inside of isn't tested again below.
template <class Found>
void SceneView::cull_subtrees(std::uint32_t begin, std::uint32_t end, const Frustum& frustum, Found found) {
  open_.clear();
  for (std::uint32_t i = begin; i < end;) {
    while (!open_.empty() && open_.back().end <= i) open_.pop_back();
    PlaneMask active = open_.empty() ? frustum.all() : open_.back().active;
    const std::uint32_t subtree_end = scene_.instances[i].subtree_end;
    assert(open_.empty() || subtree_end <= open_.back().end);
    if (collision::in_view(frustum, boxes_.box(i, Surfaces::kDrawn), active) == InView::kOutside) {
      i = subtree_end;
      continue;
    }
    if (is_surface(scene_, i, Surfaces::kDrawn) && found(i, active)) return;
    open_.push_back({subtree_end, active});
    ++i;
  }
}

std::expected<std::span<const ShapeInView>, std::string> SceneView::in_view(const Frustum& frustum, int levels) {
  assert(levels >= 0);
  in_view_.clear();
  std::string error;
  const auto end = static_cast<std::uint32_t>(scene_.instances.size());
  cull_subtrees(0, end, frustum, [&](std::uint32_t shape, PlaneMask active) {
    const auto seen = levels > 0 ? shape_in_view(shape, frustum, active, levels) : true;
    if (!seen) {
      error = seen.error();
    } else if (*seen) {
      in_view_.push_back({scene_.id_of(shape), active == 0});
    }
    return !seen.has_value();
  });
  if (!error.empty()) return std::unexpected(error);
  return in_view_;
}

std::expected<bool, std::string> SceneView::may_be_in_view(ObjectId object, const Frustum& frustum) {
  std::expected<bool, std::string> answer = false;
  cull_subtrees(scene_.index_of(object), scene_.at(object).subtree_end, frustum,
                [&](std::uint32_t shape, PlaneMask active) {
                  answer = shape_in_view(shape, frustum, active, ViewQuery::kAllLevels);
                  return !answer || *answer;
                });
  return answer;
}

// Looks into a Shape whose box may be in view.
std::expected<bool, std::string> SceneView::shape_in_view(std::uint32_t shape, const Frustum& frustum, PlaneMask active,
                                                          int levels) {
  if (active == 0) return placement_.mesh(shape).polygon_count() > 0;
  const auto of_shape = placement_.scaled_geometry(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return false;
  return views_.may_be_in_view(placement_.tree(shape, **of_shape), placement_.placed(shape).pose.pose, frustum, active,
                               levels);
}

}  // namespace peerd::collision
