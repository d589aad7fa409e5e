#include "collision/scene_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
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

// Where a ray enters a box, or no later; nothing: it certainly has no point of what is in there. The room is for the
// rounding of this, and of the ray on its way to a Shape's frame, which turns it by a few units in the last place.
std::optional<double> entry(const Ray& ray, const WorldBox& box) {
  if (box.is_empty()) return std::nullopt;
  const double pad = 0x1p-44 * (largest(box) + ray.origin.cwiseAbs().maxCoeff());
  double first = 0.0, last = ray.longest;
  for (int k = 0; k < 3; ++k) {
    const double to_lo = (box.lo[k] - pad) - ray.origin[k], to_hi = (box.hi[k] + pad) - ray.origin[k];
    if (ray.direction[k] == 0.0) {
      if (to_lo > 0.0 || to_hi < 0.0) return std::nullopt;
      continue;
    }
    const double t_lo = to_lo / ray.direction[k], t_hi = to_hi / ray.direction[k];
    first = std::max(first, std::min(t_lo, t_hi));
    last = std::min(last, std::max(t_lo, t_hi));
  }
  if (first > last * (1.0 + 0x1p-50)) return std::nullopt;
  return first;
}

// Of a triangle with these two sides, against a unit direction.
Vec3 facing_normal(const Vec3& u, const Vec3& v, const Vec3& direction) {
  const double size = std::max(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
  if (!(size > 0.0)) return Vec3::Zero();
  const Vec3 a = u / size, b = v / size;
  const Vec3 n(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  const double length = std::sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  const double towards = (n[0] * direction[0] + n[1] * direction[1]) + n[2] * direction[2];
  if (!(length > 0.0) || towards == 0.0) return Vec3::Zero();
  return n / (towards > 0.0 ? -length : length);
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
      boxes_({std::vector<std::optional<WorldBox>>(scene.instances.size()),
              std::vector<std::optional<WorldBox>>(scene.instances.size())}) {}

void SceneQuery::place(std::span<const TransformFields> transforms) {
  assert(transforms.size() == scene_.transforms.size());
  transforms_.assign(transforms.begin(), transforms.end());
  std::ranges::fill(placed_, Placed{});
  for (auto& boxes : boxes_) std::ranges::fill(boxes, std::nullopt);
}

void SceneQuery::reshape(std::uint32_t geometry, const Geometry& form) {
  meshes_[geometry] = build_mesh(form, scene_.tessellation);
  ++counters_.meshes_built;
  local_boxes_[geometry].reset();
  for (auto& boxes : boxes_) std::ranges::fill(boxes, std::nullopt);
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

bool SceneQuery::is_surface(std::uint32_t instance, Surfaces which) const {
  const Instance& i = scene_.instances[instance];
  return i.geometry != Instance::kNone && (which == Surfaces::kDrawn ? i.drawn : i.collides);
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
const WorldBox& SceneQuery::box(std::uint32_t instance, Surfaces which) {
  auto& boxes = boxes_[static_cast<std::size_t>(which)];
  auto& others = boxes_[1 - static_cast<std::size_t>(which)];
  if (boxes[instance]) return *boxes[instance];
  for (std::uint32_t i = scene_.instances[instance].subtree_end; i-- > instance;) {
    if (boxes[i]) continue;
    WorldBox box;
    const std::uint32_t end = scene_.instances[i].subtree_end;
    if (is_surface(i, which)) {  // a Shape's box is the same whatever it is for
      const bool other = end == i + 1 && is_surface(i, Surfaces::kDrawn) && is_surface(i, Surfaces::kColliding);
      box = other && others[i] ? *others[i] : shape_box(i);
    }
    for (std::uint32_t child = i + 1; child < end; child = scene_.instances[child].subtree_end) {
      box.merge(*boxes[child]);
    }
    boxes[i] = box;
  }
  return *boxes[instance];
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

void SceneQuery::enter(std::uint32_t instance, const Ray& world) {
  const auto t = entry(world, box(instance, Surfaces::kDrawn));
  if (!t || (picked_ && *t > picked_->t)) return;
  entries_.push_back({*t, instance});
  std::ranges::push_heap(entries_, std::greater());
}

// The nearest hit so far is the longest that the ray can be; what is hit there as well counts where its id is lower.
std::expected<void, std::string> SceneQuery::pick_shape(std::uint32_t shape, const Ray& world) {
  const auto of_shape = shaped(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return {};
  const Pose& pose = placed(shape).pose;
  const Mat3 back = pose.orientation.toRotationMatrix().transpose();
  const Ray ray{multiply(back, Vec3(world.origin - pose.position)), multiply(back, world.direction),
                picked_ ? picked_->t : world.longest};
  if (!is_usable(ray)) return std::unexpected(scene_.path_of({shape}) + ": it has no finite place near the ray");
  const auto hit = rays_.nearest(tree(shape, **of_shape), ray);
  if (!hit || (picked_ && hit->t == picked_->t && shape > picked_->shape)) return {};
  picked_ = {hit->t, shape, *hit};
  return {};
}

std::expected<std::optional<Pick>, std::string> SceneQuery::pick(const Vec3& origin_world, const Vec3& direction_world,
                                                                 double longest_m) {
  Ray world{origin_world, direction_world, longest_m};
  if (!is_usable(world)) {
    return std::unexpected("a ray needs a finite origin, a direction that is neither zero nor infinite, and a length");
  }
  const Vec3& d = world.direction;
  const double length = std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);  // nothing over- or underflows
  world.longest = longest_m / length;
  picked_.reset();
  entries_.clear();
  for (std::uint32_t i = 0; i < scene_.instances.size(); i = scene_.instances[i].subtree_end) enter(i, world);
  while (!entries_.empty()) {
    std::ranges::pop_heap(entries_, std::greater());
    const Entry next = entries_.back();
    entries_.pop_back();
    if (picked_ && next.t > picked_->t) break;  // and so are all others
    if (is_surface(next.instance, Surfaces::kDrawn)) {
      if (auto done = pick_shape(next.instance, world); !done) return std::unexpected(done.error());
    }
    const std::uint32_t end = scene_.instances[next.instance].subtree_end;
    for (std::uint32_t child = next.instance + 1; child < end; child = scene_.instances[child].subtree_end) {
      enter(child, world);
    }
  }
  if (!picked_) return std::nullopt;
  const Mat3 rotation = placed(picked_->shape).pose.orientation.toRotationMatrix();
  const Triangle triangle = placed_[picked_->shape].shaped->soup.triangle(picked_->hit.face);
  return Pick{{{picked_->shape}, picked_->hit.polygon},
              picked_->t * length,
              origin_world + picked_->t * direction_world,
              facing_normal(multiply(rotation, Vec3(triangle[1] - triangle[0])),
                            multiply(rotation, Vec3(triangle[2] - triangle[0])), direction_world / length)};
}

// In the scene's order: subtrees that are outside are skipped, and what one is wholly inside of isn't asked again
// below.
template <class Found>
void SceneQuery::look(std::uint32_t begin, std::uint32_t end, const Frustum& frustum, Found found) {
  open_.clear();
  for (std::uint32_t i = begin; i < end;) {
    while (!open_.empty() && open_.back().end <= i) open_.pop_back();
    PlaneMask active = open_.empty() ? frustum.all() : open_.back().active;
    const std::uint32_t subtree_end = scene_.instances[i].subtree_end;
    if (collision::in_view(frustum, box(i, Surfaces::kDrawn), active) == InView::kOutside) {
      i = subtree_end;
      continue;
    }
    if (is_surface(i, Surfaces::kDrawn) && found(i, active)) return;
    open_.push_back({subtree_end, active});
    ++i;
  }
}

std::expected<std::span<const ShapeInView>, std::string> SceneQuery::in_view(const Frustum& frustum, int levels) {
  in_view_.clear();
  std::string error;
  look(0, static_cast<std::uint32_t>(scene_.instances.size()), frustum, [&](std::uint32_t shape, PlaneMask active) {
    const auto seen = levels > 0 ? shape_in_view(shape, frustum, active, levels) : true;
    if (!seen)
      error = seen.error();
    else if (*seen)
      in_view_.push_back({{shape}, active == 0});
    return !seen.has_value();
  });
  if (!error.empty()) return std::unexpected(error);
  return in_view_;
}

std::expected<bool, std::string> SceneQuery::may_be_in_view(ObjectId object, const Frustum& frustum) {
  std::expected<bool, std::string> answer = false;
  look(object.value, scene_.at(object).subtree_end, frustum, [&](std::uint32_t shape, PlaneMask active) {
    answer = shape_in_view(shape, frustum, active, ViewQuery::kAllLevels);
    return !answer || *answer;
  });
  return answer;
}

// A Shape whose box may be in view.
std::expected<bool, std::string> SceneQuery::shape_in_view(std::uint32_t shape, const Frustum& frustum,
                                                           PlaneMask active, int levels) {
  if (active == 0) return mesh(scene_.instances[shape].geometry).polygon_count() > 0;
  const auto of_shape = shaped(shape);
  if (!of_shape) return std::unexpected(of_shape.error());
  if ((*of_shape)->soup.faces.empty()) return false;
  return views_.may_be_in_view(tree(shape, **of_shape), placed(shape).pose, frustum, active, levels);
}

SceneQueryCounters SceneQuery::counters() const {
  SceneQueryCounters out = counters_;
  out.queries = query_.counters();
  out.rays = rays_.counters();
  out.views = views_.counters();
  for (const auto& [key, shaped] : shaped_) {
    if (shaped->tree) out.nodes_built += shaped->tree->nodes_built();
  }
  return out;
}

}  // namespace peerd::collision
