#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/scene/scene.hpp"

namespace peerd::view {

// One level of the hierarchy of 18-DOPs over all polygons at and below an object (the thesis, 3.2 and figure B.9): the
// nodes that are so far below the root, and the leaves above that. It is the tree of collision/tree/kdop_tree.hpp,
// which answers as the boxes do that queries run on.
struct HierarchyLevel {
  using Polygon = std::vector<Vec3>;  // in the object's rigid frame [m]

  std::vector<std::vector<Polygon>> volumes;  // the faces of each node's 18-DOP
  bool is_last = false;                       // all of them are leaves
  std::uint32_t left_out = 0;                 // nodes beyond kVolumes
  std::size_t triangles = 0;                  // of the object
};

inline constexpr std::uint32_t kVolumes = 512, kLevels = 24;
inline constexpr std::size_t kTrianglesMax = 20'000;  // an object of more has no answer: it would hold up ticks

// `level` <= kLevels. The error is a few words for people.
[[nodiscard]] std::expected<HierarchyLevel, std::string> hierarchy_level(const Scene& scene, ObjectId object,
                                                                         std::uint32_t level);

// The members of a reply: `volumes`, each with its faces as flat lists of coordinates, `is_last`, `left_out`,
// `triangles`.
[[nodiscard]] nlohmann::ordered_json to_json(const HierarchyLevel& level);

}  // namespace peerd::view
