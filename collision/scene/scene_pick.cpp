#include "collision/scene/scene_pick.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "core/box.hpp"

namespace peerd::collision {
namespace {

// The parameter at which a ray enters a box, or one before; nothing where the ray certainly has no point of what is in
// the box. The padding is for the rounding of this function, and of the ray on its way to a Shape's frame, which turns
// it by a few units in the last place.
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

// The unit normal of a triangle with these two sides, against a unit direction.
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

ScenePick::ScenePick(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes)
    : scene_(scene), placement_(placement), boxes_(boxes) {}

void ScenePick::push_if_hit(std::uint32_t instance, const Ray& world) {
  const auto t = entry(world, boxes_.box(instance, Surfaces::kDrawn));
  if (!t || (nearest_ && *t > nearest_->t)) return;
  entries_.push_back({*t, instance});
  std::ranges::push_heap(entries_, std::greater());
}

// The nearest hit so far is the longest that the ray can be; an equally near hit counts where the Shape's id is lower.
std::expected<void, std::string> ScenePick::test_shape(std::uint32_t shape, const Ray& world) {
  const auto of_shape = placement_.scaled_geometry(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return {};
  const Pose& pose = placement_.placed(shape).pose.pose;
  const Mat3 back = pose.orientation.toRotationMatrix().transpose();
  const Ray ray{multiply(back, Vec3(world.origin - pose.position)), multiply(back, world.direction),
                nearest_ ? nearest_->t : world.longest};
  if (!is_usable(ray))
    return std::unexpected(scene_.path_of(scene_.id_of(shape)) + ": it has no finite place near the ray");
  const auto hit = rays_.nearest(placement_.tree(shape, **of_shape), ray);
  if (!hit || (nearest_ && hit->t == nearest_->t && shape > nearest_->shape)) return {};
  assert(!nearest_ || hit->t <= nearest_->t);
  nearest_ = {hit->t, shape, *hit};
  return {};
}

std::expected<std::optional<Pick>, std::string> ScenePick::pick(const Vec3& origin_world, const Vec3& direction_world,
                                                                double longest_m) {
  Ray world{origin_world, direction_world, longest_m};
  if (!is_usable(world)) {
    return std::unexpected("a ray needs a finite origin, a direction that is neither zero nor infinite, and a length");
  }
  const Vec3& d = world.direction;
  const double length = std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);  // a usable ray's doesn't overflow
  assert(length > 0.0 && std::isfinite(length));
  world.longest = longest_m / length;
  nearest_.reset();
  entries_.clear();
  for (std::uint32_t i = 0; i < scene_.instances.size(); i = scene_.instances[i].subtree_end) push_if_hit(i, world);
  while (!entries_.empty()) {
    std::ranges::pop_heap(entries_, std::greater());
    const Entry next = entries_.back();
    entries_.pop_back();
    if (nearest_ && next.t > nearest_->t) break;  // all other boxes are entered even later
    if (is_surface(scene_, next.instance, Surfaces::kDrawn)) {
      if (auto done = test_shape(next.instance, world); !done) return std::unexpected(done.error());
    }
    const std::uint32_t end = scene_.instances[next.instance].subtree_end;
    for (std::uint32_t child = next.instance + 1; child < end; child = scene_.instances[child].subtree_end) {
      push_if_hit(child, world);
    }
  }
  if (!nearest_) return std::nullopt;
  const PlacedShape& placed = placement_.placed(nearest_->shape);
  const Mat3 rotation = placed.pose.pose.orientation.toRotationMatrix();
  const Triangle triangle = placed.scaled_geometry->soup.triangle(nearest_->hit.face);
  return Pick{{scene_.id_of(nearest_->shape), nearest_->hit.polygon},
              nearest_->t * length,
              origin_world + nearest_->t * direction_world,
              facing_normal(multiply(rotation, Vec3(triangle[1] - triangle[0])),
                            multiply(rotation, Vec3(triangle[2] - triangle[0])), direction_world / length)};
}

}  // namespace peerd::collision
