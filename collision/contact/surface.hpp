#pragma once
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "collision/tree/wide_tree.hpp"
#include "core/ids.hpp"
#include "core/shape_polygon.hpp"

namespace peerd::collision {

// All polygons below an object, in its frame, as one soup whose polygons are numbered through its Shapes.
class Surface {
 public:
  Surface() = default;
  Surface(Surface&&) = delete;  // its tree knows where its soup is

  [[nodiscard]] const TriangleSoup& soup() const { return soup_; }
  [[nodiscard]] ShapePolygon polygon(std::uint32_t of_soup) const;
  // The unit direction of the sum of its triangles' cross products, object frame; none where that sum has no finite
  // length above 0.
  [[nodiscard]] std::optional<Vec3> normal(std::uint32_t polygon_of_soup) const;
  // The hierarchy is begun by the first call, and built as deep as queries go. So a body is for one thread at a time.
  [[nodiscard]] WideTree& tree();

  // Appends a Shape's polygons, taken to the object's frame by `place`; not after the first call of tree(). The error
  // names a vertex that is too far out; then the vertices are appended even so, and the polygons aren't.
  [[nodiscard]] std::expected<void, std::string> append(ObjectId shape, const Mesh& mesh,
                                                        const std::function<Vec3(const Eigen::Vector3f&)>& place);

 private:
  TriangleSoup soup_;
  std::vector<std::pair<std::uint32_t, ObjectId>> shapes_;  // for each Shape the number of its first polygon, ascending
  std::uint32_t polygons_ = 0;
  std::optional<WideTree> tree_;
};

}  // namespace peerd::collision
