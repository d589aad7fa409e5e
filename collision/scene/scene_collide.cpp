// What collides in a scene.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "collision/scene/scene_query.hpp"
#include "collision/scene/world_box.hpp"

namespace peerd::collision {

// The seed's listing 3.5: group against group, down to pairs of shapes whose boxes overlap.
struct SceneQuery::Search {
  SceneQuery& query;
  const std::function<bool(const ClosePair&)>& visit;
  double gap_m = 0.0;  // boxes that are no farther apart count as overlapping
  std::string error{};

  // True where the search is over.
  bool run(ObjectId collider, ObjectId collidee) {
    const auto end = [&](std::uint32_t i) { return query.scene_.instances[i].subtree_end; };
    const std::uint32_t end_a = end(collider.value), end_b = end(collidee.value);
    for (std::uint32_t a = collider.value; a < end_a;) {
      if (!overlap(query.box(a), query.box(collidee.value), gap_m)) {
        a = end(a);
        continue;
      }
      if (query.is_surface(a)) {
        for (std::uint32_t b = collidee.value; b < end_b;) {
          const bool apart = !overlap(query.box(a), query.box(b), gap_m);
          if (!apart && a != b && query.is_surface(b) && shapes(a, b)) return true;
          b = apart ? end(b) : b + 1;
        }
      }
      ++a;
    }
    return false;
  }

  bool shapes(std::uint32_t collider, std::uint32_t collidee) {
    const auto of_collider = query.scaled_geometry(collider), of_collidee = query.scaled_geometry(collidee);
    if (!of_collider || !of_collidee) {
      error = of_collider ? of_collidee.error() : of_collider.error();
      return true;
    }
    if ((*of_collider)->soup.faces.empty() || (*of_collidee)->soup.faces.empty()) return false;
    const bool collider_first = collider < collidee;
    const std::uint32_t a = collider_first ? collider : collidee, b = collider_first ? collidee : collider;
    ScaledGeometry& shaped_a = collider_first ? **of_collider : **of_collidee;
    ScaledGeometry& shaped_b = collider_first ? **of_collidee : **of_collider;
    return visit({a, b, shaped_a.version, shaped_b.version, &query.tree(a, shaped_a), &query.tree(b, shaped_b),
                  RelativeMotion(query.placed(a).at.pose, query.placed(b).at.pose), collider_first});
  }
};

std::expected<void, std::string> SceneQuery::visit_close_pairs(ObjectId collider, ObjectId collidee,
                                                               const std::function<bool(const ClosePair&)>& visit) {
  apply_moves();
  Search search{*this, visit};
  (void)search.run(collider, collidee);
  if (!search.error.empty()) return std::unexpected(std::move(search.error));
  return {};
}

bool SceneQuery::separated_by(ObjectId a, ObjectId b, double gap_m) {
  apply_moves();
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

double SceneQuery::displacement_m(ObjectId object) {
  apply_moves();
  double most = 0.0;
  for (std::uint32_t i = object.value; i < scene_.at(object).subtree_end; ++i) {
    if (is_surface(i) && placed(i).updated_at == move_batch_) most = std::max(most, placed(i).displacement_m);
  }
  return most;
}

std::expected<Collision, std::string> SceneQuery::collide(ObjectId collider, ObjectId collidee, CollisionType type) {
  apply_moves();
  Collision found;
  if (type == CollisionType::kBox) {
    const auto a = tight_box(collider), b = tight_box(collidee);
    if (!a) return std::unexpected(a.error());
    if (!b) return std::unexpected(b.error());
    found.colliding = overlap(*a, *b);
    return found;
  }
  const auto searched = visit_close_pairs(collider, collidee, [&](const ClosePair& close) {
    const auto report = [&](const PolygonPair& pair) {
      const ShapePolygon of_a{{close.a}, pair.a}, of_b{{close.b}, pair.b};
      found.pairs.push_back(close.collider_first ? ShapePair{of_a, of_b} : ShapePair{of_b, of_a});
    };
    if (type == CollisionType::kWitness) {
      PolygonPair pair{};
      if (query_.find_pair(*close.tree_a, *close.tree_b, close.a_from_b, pair)) report(pair);
      return !found.pairs.empty();
    }
    for (const PolygonPair& pair : query_.all_pairs(*close.tree_a, *close.tree_b, close.a_from_b)) report(pair);
    return false;
  });
  if (!searched) return std::unexpected(searched.error());
  std::ranges::sort(found.pairs);
  found.colliding = !found.pairs.empty();
  return found;
}

}  // namespace peerd::collision
