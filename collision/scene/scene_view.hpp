#pragma once
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "collision/query/view_query.hpp"
#include "collision/scene/shape_boxes.hpp"
#include "collision/scene/shape_placement.hpp"

namespace peerd::collision {

struct ShapeInView {
  ObjectId shape;
  bool wholly = false;  // the Shape is certainly inside the frustum; if not, it may be in view
  friend auto operator<=>(const ShapeInView&, const ShapeInView&) = default;
};

// Finds which of the Shapes that are drawn may be in a frustum. The placement and the boxes outlive this object, and
// moves are applied before each call. An object keeps its memory.
class SceneView {
 public:
  SceneView(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes);
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  // The answers of SceneQuery's functions of the same names.
  [[nodiscard]] std::expected<std::span<const ShapeInView>, std::string> in_view(const Frustum& frustum, int levels);
  [[nodiscard]] std::expected<bool, std::string> may_be_in_view(ObjectId object, const Frustum& frustum);

  [[nodiscard]] const ViewCounters& counters() const { return views_.counters(); }

 private:
  struct OpenSubtree {
    std::uint32_t end = 0;
    PlaneMask active = 0;
  };
  [[nodiscard]] std::expected<bool, std::string> shape_in_view(std::uint32_t shape, const Frustum& frustum,
                                                               PlaneMask active, int levels);
  template <class Found>
  void cull_subtrees(std::uint32_t begin, std::uint32_t end, const Frustum& frustum, Found found);

  const Scene& scene_;
  ShapePlacement& placement_;
  ShapeBoxes& boxes_;
  ViewQuery views_;
  std::vector<OpenSubtree> open_;  // scratch of cull_subtrees()
  std::vector<ShapeInView> in_view_;
};

}  // namespace peerd::collision
