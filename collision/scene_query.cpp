#include "collision/scene_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "collision/hierarchy_file.hpp"

namespace peerd::collision {
namespace {

bool overlap(const WorldBox& a, const WorldBox& b) {
  for (int i = 0; i < 3; ++i) {
    if (!(a.lo[i] <= b.hi[i] && b.lo[i] <= a.hi[i])) return false;
  }
  return true;
}

double largest(const WorldBox& box) {
  double most = 0.0;
  for (int i = 0; i < 3; ++i) most = std::max({most, std::abs(box.lo[i]), std::abs(box.hi[i])});
  return most;
}

bool finite(const WorldBox& box) { return box.is_empty() || std::isfinite(largest(box)); }

}  // namespace

SceneQuery::SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy)
    : scene_(scene),
      load_hierarchy_(std::move(load_hierarchy)),
      transforms_(scene.transforms),
      meshes_(scene.geometries.size()),
      local_boxes_(scene.geometries.size()),
      placed_(scene.instances.size()),
      boxes_(scene.instances.size()) {}

void SceneQuery::place(std::span<const TransformFields> transforms) {
  assert(transforms.size() == scene_.transforms.size());
  transforms_.assign(transforms.begin(), transforms.end());
  std::ranges::fill(placed_, Placed{});
  std::ranges::fill(boxes_, std::nullopt);
}

void SceneQuery::reshape(std::uint32_t geometry, const Geometry& form) {
  meshes_[geometry] = build_mesh(form, scene_.tessellation);
  ++counters_.meshes_built;
  local_boxes_[geometry].reset();
  std::ranges::fill(boxes_, std::nullopt);
  for (auto entry = shaped_.begin(); entry != shaped_.end();) {
    if (entry->first.geometry != geometry) {
      ++entry;
      continue;
    }
    Shaped& shaped = *entry->second;
    Mat3 stretch;
    for (int i = 0; i < 9; ++i) stretch(i / 3, i % 3) = entry->first.stretch[static_cast<std::size_t>(i)];
    auto soup = make_soup(*meshes_[geometry], stretch);
    // Other polygons, or others cut otherwise, or none that are finite: it is made anew, or refused, when it is asked
    // for.
    if (soup && soup->faces == shaped.soup.faces && shaped.tree && shaped.tree->refittable()) {
      shaped.soup = std::move(*soup);
      shaped.tree->refit();
      ++counters_.hierarchies_refitted;
      ++entry;
      continue;
    }
    for (Placed& placed : placed_) {
      if (placed.shaped == &shaped) placed.shaped = nullptr;
    }
    entry = shaped_.erase(entry);
  }
}

bool SceneQuery::is_surface(std::uint32_t instance) const {
  const Instance& i = scene_.instances[instance];
  return i.geometry != Instance::kNone && i.collides;
}

const Mesh& SceneQuery::mesh(std::uint32_t geometry) {
  std::optional<Mesh>& mesh = meshes_[geometry];
  if (!mesh) {
    mesh = build_mesh(scene_.geometries[geometry], scene_.tessellation);
    ++counters_.meshes_built;
  }
  return *mesh;
}

const LocalBox& SceneQuery::local_box(std::uint32_t geometry) {
  std::optional<LocalBox>& box = local_boxes_[geometry];
  if (!box) {
    box.emplace();
    for (const Eigen::Vector3f& v : mesh(geometry).vertices) box->merge(v);
  }
  return *box;
}

const StretchedPose& SceneQuery::placed(std::uint32_t shape) {
  Placed& at = placed_[shape];
  if (!at.known) {
    std::vector<TransformFields> path;
    for (auto i = static_cast<std::int32_t>(shape); i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
      const std::uint32_t t = scene_.instances[static_cast<std::size_t>(i)].transform;
      if (t != Instance::kNone) path.push_back(transforms_[t]);
    }
    std::ranges::reverse(path);
    at.at = stretched_pose(path);
    at.known = true;
  }
  return at.at;
}

std::expected<SceneQuery::Shaped*, std::string> SceneQuery::shaped(std::uint32_t shape) {
  if (placed_[shape].shaped != nullptr) return placed_[shape].shaped;
  const std::uint32_t geometry = scene_.instances[shape].geometry;
  StretchKey key{geometry, {}};
  const Mat3& stretch = placed(shape).stretch;
  for (int i = 0; i < 9; ++i) key.stretch[static_cast<std::size_t>(i)] = stretch(i / 3, i % 3);
  std::unique_ptr<Shaped>& known = shaped_[key];
  if (known == nullptr) {
    auto soup = make_soup(mesh(geometry), stretch);
    if (!soup) return std::unexpected(scene_.path_of({shape}) + ": " + soup.error());
    ++counters_.soups_built;
    known = std::make_unique<Shaped>(std::move(*soup));
  }
  placed_[shape].shaped = known.get();
  return known.get();
}

std::optional<WideTree> SceneQuery::read_tree(std::uint32_t shape, const TriangleSoup& soup) {
  const std::string_view url = scene_.shape({shape}).hierarchy_file;
  if (url.empty() || !load_hierarchy_) return std::nullopt;
  const auto file = load_hierarchy_(url);
  std::string why;
  if (!file) {
    why = file.error();
  } else if (!*file) {
    return std::nullopt;
  } else if (auto tree = read_hierarchy(soup, (*file)->owner, (*file)->bytes)) {
    ++counters_.hierarchies_read;
    return std::move(*tree);
  } else {
    why = tree.error();
  }
  notes_.push_back(scene_.path_of({shape}) + ": hierarchyFile \"" + std::string(url) + "\" is not used: " + why);
  return std::nullopt;
}

WideTree& SceneQuery::tree(std::uint32_t shape, Shaped& shaped) {
  if (shaped.tree) return *shaped.tree;
  shaped.tree = read_tree(shape, shaped.soup);
  if (!shaped.tree) {
    shaped.tree.emplace(shaped.soup);
    ++counters_.hierarchies_built;
  }
  return *shaped.tree;
}

std::expected<std::vector<SceneQuery::Baked>, std::string> SceneQuery::bake() {
  std::vector<Baked> files;
  std::map<std::string_view, const Shaped*> of_file;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const std::string_view url = scene_.shape({i}).hierarchy_file;
    if (url.empty() || !is_surface(i)) continue;
    const auto shape = shaped(i);
    if (!shape) return std::unexpected(shape.error());
    if ((*shape)->soup.faces.empty()) continue;
    const auto [known, is_new] = of_file.try_emplace(url, *shape);
    if (!is_new && known->second != *shape) {
      return std::unexpected(scene_.path_of({i}) + ": hierarchyFile \"" + std::string(url) +
                             "\" is another Shape's too, of another geometry or scale");
    }
    if (!is_new) continue;
    WideTree tree((*shape)->soup);
    files.push_back({url, write_hierarchy(tree)});
  }
  return files;
}

WorldBox SceneQuery::shape_box(std::uint32_t shape) {
  const LocalBox& local = local_box(scene_.instances[shape].geometry);
  const StretchedPose& at = placed(shape);
  const Mat3 rotation = at.pose.orientation.toRotationMatrix();
  WorldBox box = transformed({multiply(rotation, at.stretch), at.pose.position}, local);
  ++counters_.boxes_placed;
  if (box.is_empty()) return box;
  // The vertices that decide are rounded on other ways, to the other shape's frame; these all err by a few units in the
  // last place of the largest numbers on their way.
  double linear = 0.0, reach = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) linear = std::max(linear, std::abs(at.stretch(i, j)));
    reach = std::max({reach, std::abs(static_cast<double>(local.lo[i])), std::abs(static_cast<double>(local.hi[i]))});
  }
  const double pad = 0x1p-44 * (largest(box) + 9.0 * linear * reach);
  for (int i = 0; i < 3; ++i) {
    box.lo[i] -= pad;
    box.hi[i] += pad;
  }
  return box;
}

// From the end of the subtree, so that no recursion is as deep as the scene.
const WorldBox& SceneQuery::box(std::uint32_t instance) {
  if (boxes_[instance]) return *boxes_[instance];
  for (std::uint32_t i = scene_.instances[instance].subtree_end; i-- > instance;) {
    if (boxes_[i]) continue;
    WorldBox box;
    if (is_surface(i)) box = shape_box(i);
    const std::uint32_t end = scene_.instances[i].subtree_end;
    for (std::uint32_t child = i + 1; child < end; child = scene_.instances[child].subtree_end)
      box.merge(*boxes_[child]);
    boxes_[i] = box;
  }
  return *boxes_[instance];
}

// Of the vertices that polygons use.
std::expected<WorldBox, std::string> SceneQuery::tight_box(ObjectId object) {
  WorldBox box;
  for (std::uint32_t i = object.value; i < scene_.at(object).subtree_end; ++i) {
    if (!is_surface(i)) continue;
    const Mesh& m = mesh(scene_.instances[i].geometry);
    const StretchedPose& at = placed(i);
    const Mat3 rotation = at.pose.orientation.toRotationMatrix();
    const bool stretched = at.stretch != Mat3::Identity();
    std::vector<bool> used(m.vertices.size());
    for (const std::int32_t corner : m.corners) {
      if (corner != Mesh::kEndOfPolygon) used[static_cast<std::size_t>(corner)] = true;
    }
    WorldBox of_shape;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      const Vec3 parsed = m.vertices[v].cast<double>();
      of_shape.merge(Vec3(multiply(rotation, stretched ? multiply(at.stretch, parsed) : parsed) + at.pose.position));
      ++counters_.vertices_placed;
    }
    if (!finite(of_shape))
      return std::unexpected(scene_.path_of({i}) + ": its vertices have no finite place in the world");
    box.merge(of_shape);
  }
  return box;
}

// The seed's listing 3.5: group against group, down to pairs of shapes whose boxes overlap.
struct SceneQuery::Search {
  SceneQuery& query;
  CollisionType type;
  Collision& found;
  std::string error{};

  // True where the search is over.
  bool run(ObjectId collider, ObjectId collidee) {
    const auto end = [&](std::uint32_t i) { return query.scene_.instances[i].subtree_end; };
    const std::uint32_t end_a = end(collider.value), end_b = end(collidee.value);
    for (std::uint32_t a = collider.value; a < end_a;) {
      if (!overlap(query.box(a), query.box(collidee.value))) {
        a = end(a);
        continue;
      }
      if (query.is_surface(a)) {
        for (std::uint32_t b = collidee.value; b < end_b;) {
          const bool apart = !overlap(query.box(a), query.box(b));
          if (!apart && a != b && query.is_surface(b) && shapes(a, b)) return true;
          b = apart ? end(b) : b + 1;
        }
      }
      ++a;
    }
    return false;
  }

  bool shapes(std::uint32_t collider, std::uint32_t collidee) {
    const auto of_collider = query.shaped(collider), of_collidee = query.shaped(collidee);
    if (!of_collider || !of_collidee) {
      error = of_collider ? of_collidee.error() : of_collider.error();
      return true;
    }
    if ((*of_collider)->soup.faces.empty() || (*of_collidee)->soup.faces.empty()) return false;
    const bool collider_first = collider < collidee;
    const std::uint32_t a = collider_first ? collider : collidee, b = collider_first ? collidee : collider;
    WideTree& tree_a = query.tree(a, collider_first ? **of_collider : **of_collidee);
    WideTree& tree_b = query.tree(b, collider_first ? **of_collidee : **of_collider);
    const RelativeMotion a_from_b(query.placed(a).pose, query.placed(b).pose);
    const auto report = [&](const PolygonPair& pair) {
      const ShapePolygon of_a{{a}, pair.a}, of_b{{b}, pair.b};
      found.pairs.push_back(collider_first ? ShapePair{of_a, of_b} : ShapePair{of_b, of_a});
    };
    if (type == CollisionType::kWitness) {
      PolygonPair pair{};
      if (query.query_.find_pair(tree_a, tree_b, a_from_b, pair)) report(pair);
    } else {
      for (const PolygonPair& pair : query.query_.all_pairs(tree_a, tree_b, a_from_b)) report(pair);
    }
    return type == CollisionType::kWitness && !found.pairs.empty();
  }
};

std::expected<Collision, std::string> SceneQuery::collide(ObjectId collider, ObjectId collidee, CollisionType type) {
  Collision found;
  if (type == CollisionType::kBox) {
    const auto a = tight_box(collider), b = tight_box(collidee);
    if (!a) return std::unexpected(a.error());
    if (!b) return std::unexpected(b.error());
    found.colliding = overlap(*a, *b);
    return found;
  }
  Search search{*this, type, found};
  (void)search.run(collider, collidee);
  if (!search.error.empty()) return std::unexpected(search.error);
  std::ranges::sort(found.pairs);
  found.colliding = !found.pairs.empty();
  return found;
}

SceneQueryCounters SceneQuery::counters() const {
  SceneQueryCounters out = counters_;
  out.queries = query_.counters();
  for (const auto& [key, shaped] : shaped_) {
    if (shaped->tree) out.nodes_built += shaped->tree->nodes_built();
  }
  return out;
}

}  // namespace peerd::collision
