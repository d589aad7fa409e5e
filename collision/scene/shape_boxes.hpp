#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "collision/scene/shape_placement.hpp"
#include "collision/scene/surfaces.hpp"
#include "collision/tree/kdop.hpp"
#include "core/box.hpp"

namespace peerd::collision {

// The box that collision type BOX compares.
enum class BoxBound : std::uint8_t {
  kVertices,   // the box of the vertices that polygons use, where the pose takes them
  kRealigned,  // the thesis's (realigned_box.hpp), but no larger than ShapeBoxes::box(): it reads no vertex once the
               // scaled geometry is known
};

// The world boxes of a scene's objects [m], each computed when a question needs it and kept until something in its
// subtree moves. The placement outlives this object, and its moves are applied before each call.
class ShapeBoxes {
 public:
  ShapeBoxes(const Scene& scene, ShapePlacement& placement);
  ShapeBoxes(const ShapeBoxes&) = delete;
  ShapeBoxes& operator=(const ShapeBoxes&) = delete;

  // A box of all Shapes of a set in an instance's subtree, with room for all rounding: two objects whose boxes are
  // apart don't touch in any way that collision asks for. Infinite where numbers overflow. Valid until something moves.
  [[nodiscard]] const WorldBox& box(std::uint32_t instance, Surfaces which) {
    const std::optional<WorldBox>& known = boxes_[static_cast<std::size_t>(which)][instance];
    return known ? *known : compute(instance, which);
  }
  // The box that collision type BOX compares, of all that collides in an object's subtree. The error names a Shape that
  // has no finite place in the world.
  [[nodiscard]] std::expected<WorldBox, std::string> tight_box(ObjectId object);
  void set_box_bound(BoxBound bound);

  // The subtree [begin, end) has moved.
  void invalidate_subtree(std::uint32_t begin, std::uint32_t end);
  // A Shape has another geometry.
  void invalidate_shape(std::uint32_t shape);

  [[nodiscard]] std::uint64_t boxes_placed() const { return boxes_placed_; }
  [[nodiscard]] std::uint64_t vertices_placed() const { return vertices_placed_; }

 private:
  [[nodiscard]] const WorldBox& compute(std::uint32_t instance, Surfaces which);
  void invalidate_upwards(std::uint32_t instance);
  [[nodiscard]] WorldBox shape_box(std::uint32_t shape);
  [[nodiscard]] WorldBox tight_shape_box(std::uint32_t shape);
  [[nodiscard]] WorldBox realigned_shape_box(std::uint32_t shape);

  const Scene& scene_;
  ShapePlacement& placement_;
  // By Surfaces and instance. Where the box of an instance is known, those of all instances below it are.
  std::array<std::vector<std::optional<WorldBox>>, 2> boxes_;
  std::vector<std::optional<WorldBox>> tight_boxes_;  // by instance, of its own vertices; empty before tight_box()
  BoxBound box_bound_ = BoxBound::kVertices;
  struct StretchedDop {
    Mat3 stretch;
    Kdop<18> dop;
  };
  std::vector<std::optional<StretchedDop>> dops_;  // by instance, for kRealigned; empty before
  std::uint64_t boxes_placed_ = 0, vertices_placed_ = 0;
};

}  // namespace peerd::collision
