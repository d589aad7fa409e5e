#include "collision/scene/scene_collide.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <utility>

#include "collision/scene/world_box.hpp"

namespace peerd::collision {

SceneCollide::SceneCollide(const Scene& scene, ShapePlacement& placement, ShapeBoxes& boxes)
    : scene_(scene), placement_(placement), boxes_(boxes) {}

// The search of the thesis's listing 3.5: group against group, down to pairs of Shapes whose boxes overlap.
struct SceneCollide::Search {
  SceneCollide& query;
  const std::function<bool(const ClosePair&)>& visit;
  double gap_m = 0.0;  // boxes that are no farther apart than this count as overlapping
  std::string error{};

  [[nodiscard]] const WorldBox& box(std::uint32_t i) const { return query.boxes_.box(i, Surfaces::kColliding); }
  [[nodiscard]] bool collides(std::uint32_t i) const { return is_surface(query.scene_, i, Surfaces::kColliding); }

  // True where the search has ended before all pairs were visited.
  bool run(ObjectId collider, ObjectId collidee) {
    const auto end = [&](std::uint32_t i) { return query.scene_.instances[i].subtree_end; };
    const std::uint32_t first_a = query.scene_.index_of(collider), first_b = query.scene_.index_of(collidee);
    const std::uint32_t end_a = end(first_a), end_b = end(first_b);
    for (std::uint32_t a = first_a; a < end_a;) {
      if (!overlap(box(a), box(first_b), gap_m)) {
        a = end(a);
        continue;
      }
      if (collides(a)) {
        for (std::uint32_t b = first_b; b < end_b;) {
          const bool apart = !overlap(box(a), box(b), gap_m);
          if (!apart && a != b && collides(b) && visit_shapes(a, b)) return true;
          b = apart ? end(b) : b + 1;
        }
      }
      ++a;
    }
    return false;
  }

  bool visit_shapes(std::uint32_t collider, std::uint32_t collidee) {
    ShapePlacement& placement = query.placement_;
    const auto of_collider = placement.scaled_geometry(collider), of_collidee = placement.scaled_geometry(collidee);
    if (!of_collider || !of_collidee) {
      error = of_collider ? of_collidee.error() : of_collider.error();
      return true;
    }
    if ((*of_collider)->soup.faces.empty() || (*of_collidee)->soup.faces.empty()) return false;
    const bool collider_first = collider < collidee;
    const std::uint32_t a = collider_first ? collider : collidee, b = collider_first ? collidee : collider;
    ScaledGeometry& scaled_a = collider_first ? **of_collider : **of_collidee;
    ScaledGeometry& scaled_b = collider_first ? **of_collidee : **of_collider;
    assert(a < b && scaled_a.version > 0 && scaled_b.version > 0);
    return visit({a, b, scaled_a.version, scaled_b.version, &placement.tree(a, scaled_a), &placement.tree(b, scaled_b),
                  RelativeMotion(placement.placed(a).pose.pose, placement.placed(b).pose.pose), collider_first});
  }
};

std::expected<void, std::string> SceneCollide::visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                                 const std::function<bool(const ClosePair&)>& visit) {
  Search search{*this, visit};
  (void)search.run(collider, collidee);
  if (!search.error.empty()) return std::unexpected(std::move(search.error));
  return {};
}

bool SceneCollide::separated_by(ObjectId a, ObjectId b, double gap_m) {
  assert(gap_m >= 0.0);
  bool apart = true;
  const auto visit = [&](const ClosePair& close) {
    apart = query_.separated_by(*close.tree_a, *close.tree_b, close.a_from_b, gap_m);
    return !apart;
  };
  const std::function<bool(const ClosePair&)> visitor = std::ref(visit);
  Search search{*this, visitor, gap_m};
  (void)search.run(a, b);
  return apart && search.error.empty();
}

std::expected<Collision, std::string> SceneCollide::collide(ObjectId collider, ObjectId collidee, CollisionType type) {
  Collision found;
  if (type == CollisionType::kBox) {
    const auto a = boxes_.tight_box(collider), b = boxes_.tight_box(collidee);
    if (!a) return std::unexpected(a.error());
    if (!b) return std::unexpected(b.error());
    found.colliding = overlap(*a, *b);
    return found;
  }
  const auto soup_of_a = [&](const ClosePair& close) {
    return NumberedSoup{close.version_a, &close.tree_a->soup(), placement_.placed(close.a).pose.pose};
  };
  const auto soup_of_b = [&](const ClosePair& close) {
    return NumberedSoup{close.version_b, &close.tree_b->soup(), placement_.placed(close.b).pose.pose};
  };
  const auto find_pair = [&](const ClosePair& close, PolygonPair& pair) {
    if (narrow_phase_ == nullptr) return query_.find_pair(*close.tree_a, *close.tree_b, close.a_from_b, pair);
    return narrow_phase_->find_pair(soup_of_a(close), soup_of_b(close), close.a_from_b, pair);
  };
  const auto all_pairs = [&](const ClosePair& close) {
    if (narrow_phase_ == nullptr) return query_.all_pairs(*close.tree_a, *close.tree_b, close.a_from_b);
    return narrow_phase_->all_pairs(soup_of_a(close), soup_of_b(close), close.a_from_b);
  };
  const auto searched = visit_close_pairs(collider, collidee, [&](const ClosePair& close) {
    const auto report = [&](const PolygonPair& pair) {
      const ShapePolygon of_a{scene_.id_of(close.a), pair.a}, of_b{scene_.id_of(close.b), pair.b};
      found.pairs.push_back(close.collider_first ? ShapePair{of_a, of_b} : ShapePair{of_b, of_a});
    };
    if (type == CollisionType::kWitness) {
      PolygonPair pair{};
      if (find_pair(close, pair)) report(pair);
      return !found.pairs.empty();
    }
    for (const PolygonPair& pair : all_pairs(close)) report(pair);
    return false;
  });
  if (!searched) return std::unexpected(searched.error());
  std::ranges::sort(found.pairs);
  assert(std::ranges::adjacent_find(found.pairs) == found.pairs.end());
  found.colliding = !found.pairs.empty();
  return found;
}

}  // namespace peerd::collision
