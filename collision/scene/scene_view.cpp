// What is seen of a scene: picking by ray, and views.
#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/scene/scene_query.hpp"
#include "collision/scene/world_box.hpp"

namespace peerd::collision {
namespace {

// Where a ray enters a box, or no later; nothing: it certainly has no point of what is in there. The room is for the
// rounding of this, and of the ray on its way to a Shape's frame, which turns it by a few units in the last place.
std::optional<double> entry(const Ray& ray, const WorldBox& box) {
  if (box.is_empty()) return std::nullopt;
  const double pad = 0x1p-44 * (largest_coordinate(box) + ray.origin.cwiseAbs().maxCoeff());
  double first = 0.0, last = ray.longest;
  for (int k = 0; k < 3; ++k) {
    const double to_lo = (box.lo[k] - pad) - ray.origin[k], to_hi = (box.hi[k] + pad) - ray.origin[k];
    if (ray.direction[k] == 0.0) {
      if (to_lo > 0.0 || to_hi < 0.0) return std::nullopt;
      continue;
    }
    const double t_lo = to_lo / ray.direction[k], t_hi = to_hi / ray.direction[k];
    first = std::max(first, std::min(t_lo, t_hi));
    last = std::min(last, std::max(t_lo, t_hi));
  }
  if (first > last * (1.0 + 0x1p-50)) return std::nullopt;
  return first;
}

// Of a triangle with these two sides, against a unit direction.
Vec3 facing_normal(const Vec3& u, const Vec3& v, const Vec3& direction) {
  const double size = std::max(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
  if (!(size > 0.0)) return Vec3::Zero();
  const Vec3 a = u / size, b = v / size;
  const Vec3 n(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  const double length = std::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  const double towards = (n[0] * direction[0] + n[1] * direction[1]) + n[2] * direction[2];
  if (!(length > 0.0) || towards == 0.0) return Vec3::Zero();
  return n / (towards > 0.0 ? -length : length);
}

}  // namespace

void SceneQuery::push_if_hit(std::uint32_t instance, const Ray& world) {
  const auto t = entry(world, box(instance, Surfaces::kDrawn));
  if (!t || (picked_ && *t > picked_->t)) return;
  entries_.push_back({*t, instance});
  std::ranges::push_heap(entries_, std::greater());
}

// The nearest hit so far is the longest that the ray can be; what is hit there as well counts where its id is lower.
std::expected<void, std::string> SceneQuery::pick_shape(std::uint32_t shape, const Ray& world) {
  const auto of_shape = scaled_geometry(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return {};
  const Pose& pose = placed(shape).at.pose;
  const Mat3 back = pose.orientation.toRotationMatrix().transpose();
  const Ray ray{multiply(back, Vec3(world.origin - pose.position)), multiply(back, world.direction),
                picked_ ? picked_->t : world.longest};
  if (!is_usable(ray)) return std::unexpected(scene_.path_of({shape}) + ": it has no finite place near the ray");
  const auto hit = rays_.nearest(tree(shape, **of_shape), ray);
  if (!hit || (picked_ && hit->t == picked_->t && shape > picked_->shape)) return {};
  picked_ = {hit->t, shape, *hit};
  return {};
}

std::expected<std::optional<Pick>, std::string> SceneQuery::pick(const Vec3& origin_world, const Vec3& direction_world,
                                                                 double longest_m) {
  apply_moves();
  Ray world{origin_world, direction_world, longest_m};
  if (!is_usable(world)) {
    return std::unexpected("a ray needs a finite origin, a direction that is neither zero nor infinite, and a length");
  }
  const Vec3& d = world.direction;
  const double length = std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);  // nothing over- or underflows
  world.longest = longest_m / length;
  picked_.reset();
  entries_.clear();
  for (std::uint32_t i = 0; i < scene_.instances.size(); i = scene_.instances[i].subtree_end) push_if_hit(i, world);
  while (!entries_.empty()) {
    std::ranges::pop_heap(entries_, std::greater());
    const Entry next = entries_.back();
    entries_.pop_back();
    if (picked_ && next.t > picked_->t) break;  // and so are all others
    if (is_surface(next.instance, Surfaces::kDrawn)) {
      if (auto done = pick_shape(next.instance, world); !done) return std::unexpected(done.error());
    }
    const std::uint32_t end = scene_.instances[next.instance].subtree_end;
    for (std::uint32_t child = next.instance + 1; child < end; child = scene_.instances[child].subtree_end) {
      push_if_hit(child, world);
    }
  }
  if (!picked_) return std::nullopt;
  const Mat3 rotation = placed(picked_->shape).at.pose.orientation.toRotationMatrix();
  const Triangle triangle = placed_[picked_->shape].scaled_geometry->soup.triangle(picked_->hit.face);
  return Pick{{{picked_->shape}, picked_->hit.polygon},
              picked_->t * length,
              origin_world + picked_->t * direction_world,
              facing_normal(multiply(rotation, Vec3(triangle[1] - triangle[0])),
                            multiply(rotation, Vec3(triangle[2] - triangle[0])), direction_world / length)};
}

// In the scene's order: subtrees that are outside are skipped, and what one is wholly inside of isn't asked again
// below.
template <class Found>
void SceneQuery::cull_subtrees(std::uint32_t begin, std::uint32_t end, const Frustum& frustum, Found found) {
  apply_moves();
  open_.clear();
  for (std::uint32_t i = begin; i < end;) {
    while (!open_.empty() && open_.back().end <= i) open_.pop_back();
    PlaneMask active = open_.empty() ? frustum.all() : open_.back().active;
    const std::uint32_t subtree_end = scene_.instances[i].subtree_end;
    if (collision::in_view(frustum, box(i, Surfaces::kDrawn), active) == InView::kOutside) {
      i = subtree_end;
      continue;
    }
    if (is_surface(i, Surfaces::kDrawn) && found(i, active)) return;
    open_.push_back({subtree_end, active});
    ++i;
  }
}

std::expected<std::span<const ShapeInView>, std::string> SceneQuery::in_view(const Frustum& frustum, int levels) {
  in_view_.clear();
  std::string error;
  cull_subtrees(0, static_cast<std::uint32_t>(scene_.instances.size()), frustum,
                [&](std::uint32_t shape, PlaneMask active) {
                  const auto seen = levels > 0 ? shape_in_view(shape, frustum, active, levels) : true;
                  if (!seen)
                    error = seen.error();
                  else if (*seen)
                    in_view_.push_back({{shape}, active == 0});
                  return !seen.has_value();
                });
  if (!error.empty()) return std::unexpected(error);
  return in_view_;
}

std::expected<bool, std::string> SceneQuery::may_be_in_view(ObjectId object, const Frustum& frustum) {
  std::expected<bool, std::string> answer = false;
  cull_subtrees(object.value, scene_.at(object).subtree_end, frustum, [&](std::uint32_t shape, PlaneMask active) {
    answer = shape_in_view(shape, frustum, active, ViewQuery::kAllLevels);
    return !answer || *answer;
  });
  return answer;
}

// A Shape whose box may be in view.
std::expected<bool, std::string> SceneQuery::shape_in_view(std::uint32_t shape, const Frustum& frustum,
                                                           PlaneMask active, int levels) {
  if (active == 0) return mesh(scene_.instances[shape].geometry).polygon_count() > 0;
  const auto of_shape = scaled_geometry(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return false;
  return views_.may_be_in_view(tree(shape, **of_shape), placed(shape).at.pose, frustum, active, levels);
}

}  // namespace peerd::collision
