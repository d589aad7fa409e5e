#pragma once
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "collision/query/ray_query.hpp"
#include "collision/scene/scene_collide.hpp"
#include "collision/scene/shape_boxes.hpp"
#include "collision/scene/shape_placement.hpp"

namespace peerd::collision {

// The polygon that a ray hits first.
struct Pick {
  ShapePolygon at;
  double distance_m = 0.0;          // from the origin, rounded
  Vec3 point_world = Vec3::Zero();  // origin + t * direction, rounded [m]
  // The unit normal of the triangle that was hit, to the side from which the ray comes; zero where the triangle has no
  // area, as rounded, or the ray is in its plane.
  Vec3 normal_world = Vec3::Zero();
};

// Finds what a ray hits first among the Shapes that are drawn. The placement and the boxes outlive this object, and
// moves are applied before each call. An object keeps its memory.
class ScenePick {
 public:
  ScenePick(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes);
  ScenePick(const ScenePick&) = delete;
  ScenePick& operator=(const ScenePick&) = delete;

  // The answer of SceneQuery::pick().
  [[nodiscard]] std::expected<std::optional<Pick>, std::string> pick(const Vec3& origin_world,
                                                                     const Vec3& direction_world, double longest_m);

  [[nodiscard]] const RayCounters& counters() const { return rays_.counters(); }

 private:
  struct Entry {
    double t = 0.0;  // no later than where the ray enters the instance's box
    std::uint32_t instance = 0;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };
  struct Nearest {
    double t = 0.0;
    std::uint32_t shape = 0;
    RayHit hit;
  };
  [[nodiscard]] std::expected<void, std::string> test_shape(std::uint32_t shape, const Ray& world);
  void push_if_hit(std::uint32_t instance, const Ray& world);

  const Scene& scene_;
  ShapePlacement& placement_;
  ShapeBoxes& boxes_;
  RayQuery rays_;
  std::vector<Entry> entries_;      // a heap, the first entered box on top
  std::optional<Nearest> nearest_;  // the nearest hit so far
};

}  // namespace peerd::collision
