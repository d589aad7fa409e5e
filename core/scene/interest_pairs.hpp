#pragma once
#include <cstdint>
#include <vector>

#include "core/scene/path_resolver.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// Puts what the patterns of an interest find in the scene behind what it names, in place of what they found before.
void find_ends(CollisionInterest& interest, vrml::PathResolver& paths);

// The pairs of an interest: each collider with each collidee, but for two that are one, and, where a pattern has found
// one of the two, for two of which one is inside the other, or that share no layer.
class InterestPairs {
 public:
  // The interest and the scene outlive it and stay as they are.
  InterestPairs(const Scene& scene, const CollisionInterest& interest);

  // Calls `function(collider, collidee)` for each pair, in the order of the interest.
  template <class Function>
  void for_each(Function function) const {
    for (const End& a : colliders_) {
      for (const End& b : collidees_) {
        if (are_paired(a, b)) function(a.id, b.id);
      }
    }
  }
  [[nodiscard]] std::size_t count() const;

 private:
  struct End {
    ObjectId id;
    std::uint32_t begin, end;  // of its subtree
    std::uint32_t layers;
    bool by_pattern;
  };
  [[nodiscard]] static std::vector<End> ends_of(const Scene& scene, const InterestSide& side);
  [[nodiscard]] static bool are_paired(const End& a, const End& b) {
    if (a.id == b.id) return false;
    if (!a.by_pattern && !b.by_pattern) return true;
    return (a.end <= b.begin || b.end <= a.begin) && (a.layers & b.layers) != 0;
  }

  std::vector<End> colliders_, collidees_;
};

}  // namespace peerd
