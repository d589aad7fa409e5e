#pragma once
#include <cstdint>
#include <vector>

#include "collision/exact/relative_motion.hpp"
#include "collision/exact/triangle_soup.hpp"
#include "collision/query/tree_query.hpp"

namespace peerd::collision {

// A soup under a number that no other triangles ever had: what is built for it may be kept by that number.
struct NumberedSoup {
  std::uint64_t number = 0;
  const TriangleSoup* soup = nullptr;  // it has a face, and stays where it is for as long as it is asked about
  // Maps the soup's frame to the world; a way that asks about more than two soups' relative motion needs it.
  Pose pose{};
};

// A NarrowPhase answers whether two soups touch, and with which polygons. SceneQuery asks it in place of the wide trees
// (set_narrow_phase()), so that other systems' ways can be tried on the same scenes (collision/engines).
class NarrowPhase {
 public:
  virtual ~NarrowPhase() = default;

  // One pair of polygons that touch, B's vertices being taken to A's frame; false: there is none, and `pair` is as it
  // was. An approximate way may take what is only near for a touch.
  [[nodiscard]] virtual bool find_pair(const NumberedSoup& a, const NumberedSoup& b, const RelativeMotion& a_from_b,
                                       PolygonPair& pair) = 0;
  // All such pairs, sorted, each once.
  [[nodiscard]] virtual std::vector<PolygonPair> all_pairs(const NumberedSoup& a, const NumberedSoup& b,
                                                           const RelativeMotion& a_from_b) = 0;
  [[nodiscard]] virtual const QueryCounters& counters() const = 0;
};

}  // namespace peerd::collision
