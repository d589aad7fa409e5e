#include "collision/scene/scene_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

#include "collision/exact/infinity.hpp"
#include "collision/scene/world_box.hpp"
#include "collision/tree/hierarchy_file.hpp"
#include "collision/tree/realigned_box.hpp"

namespace peerd::collision {
namespace {

// No point of the box goes farther [m]. The difference of two affine maps is one, so its length is greatest at a
// corner. The rounding of all this is some 2^-50 of `reach`, and so is that of the vertices that decide.
double displacement_bound_m(const Affine& from, const Affine& to, const LocalBox& box) {
  if (box.is_empty()) return 0.0;
  Vec3 middle = to.offset - from.offset, aside[3];
  double reach = to.offset.cwiseAbs().maxCoeff() + from.offset.cwiseAbs().maxCoeff();
  for (int i = 0; i < 3; ++i) {
    const Vec3 turned = to.linear.col(i) - from.linear.col(i);
    const double lo = box.lo[i], hi = box.hi[i];
    middle += turned * (0.5 * (lo + hi));
    aside[i] = turned * (0.5 * (hi - lo));
    const double linear = to.linear.col(i).cwiseAbs().maxCoeff() + from.linear.col(i).cwiseAbs().maxCoeff();
    reach += 9.0 * linear * std::max(std::abs(lo), std::abs(hi));
  }
  double most = 0.0;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vec3 edge = middle + x * aside[0] + y * aside[1];
      most = std::max({most, (edge + aside[2]).squaredNorm(), (edge - aside[2]).squaredNorm()});
    }
  }
  return std::sqrt(most) * (1.0 + 0x1p-48) + 0x1p-41 * reach;
}

bool finite(const WorldBox& box) { return box.is_empty() || std::isfinite(largest_coordinate(box)); }

// Before all others that are numbers.
constexpr std::array<double, 9> kLeastStretch = [] {
  std::array<double, 9> least{};
  least.fill(-kInfinity);
  return least;
}();

bool equal(const TransformFields& a, const TransformFields& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs() && a.scale == b.scale &&
         a.scale_orientation.coeffs() == b.scale_orientation.coeffs() && a.center == b.center;
}

}  // namespace

SceneQuery::InstanceIndex::InstanceIndex(const Scene& scene, std::uint32_t Instance::*member, std::size_t count)
    : begin_(count + 1) {
  for (const Instance& i : scene.instances) {
    if (i.*member != Instance::kNone) ++begin_[i.*member + 1];
  }
  for (std::size_t t = 0; t < count; ++t) begin_[t + 1] += begin_[t];
  instances_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (const std::uint32_t t = scene.instances[i].*member; t != Instance::kNone) instances_[next[t]++] = i;
  }
}

SceneQuery::SceneQuery(const Scene& scene, HierarchyLoader load_hierarchy)
    : scene_(scene),
      load_hierarchy_(std::move(load_hierarchy)),
      transforms_(scene.transforms),
      instances_of_transform_(scene, &Instance::transform, scene.transforms.size()),
      instances_of_geometry_(scene, &Instance::geometry, scene.geometries.size()),
      meshes_(scene.geometries.size()),
      local_boxes_(scene.geometries.size()),
      placed_(scene.instances.size()),
      boxes_({std::vector<std::optional<WorldBox>>(scene.instances.size()),
              std::vector<std::optional<WorldBox>>(scene.instances.size())}) {}

bool SceneQuery::move(std::uint32_t transform, const TransformFields& fields) {
  if (equal(transforms_[transform], fields)) return false;
  transforms_[transform] = fields;
  const auto moved = instances_of_transform_.of(transform);
  moved_.insert(moved_.end(), moved.begin(), moved.end());
  return true;
}

void SceneQuery::set_transforms(std::span<const TransformFields> transforms) {
  assert(transforms.size() == scene_.transforms.size());
  for (std::uint32_t t = 0; t < transforms.size(); ++t) move(t, transforms[t]);
}

// What is below something that moved is passed over once, however much of it has moved as well.
void SceneQuery::apply_moves() {
  if (moved_.empty()) return;
  ++move_batch_;
  std::ranges::sort(moved_);
  std::uint32_t end = 0;
  for (const std::uint32_t moved : moved_) {
    if (moved < end) continue;
    end = scene_.instances[moved].subtree_end;
    invalidate_box(moved);
    for (std::uint32_t i = moved; i < end; ++i) {
      placed_[i].known = false;
      for (auto& boxes : boxes_) boxes[i].reset();
    }
    if (!tight_boxes_.empty()) std::fill(tight_boxes_.begin() + moved, tight_boxes_.begin() + end, std::nullopt);
  }
  moved_.clear();
}

// And those above it that know theirs: above one that doesn't, none does.
void SceneQuery::invalidate_box(std::uint32_t instance) {
  for (auto& boxes : boxes_) {
    for (auto i = static_cast<std::int32_t>(instance); i >= 0 && boxes[static_cast<std::size_t>(i)];) {
      boxes[static_cast<std::size_t>(i)].reset();
      i = scene_.instances[static_cast<std::size_t>(i)].parent;
    }
  }
}

void SceneQuery::erase_scaled_geometry(
    std::map<StretchKey, std::unique_ptr<ScaledGeometry>>::iterator scaled_geometry) {
  if (scaled_geometry->second->tree) counters_.nodes_built += scaled_geometry->second->tree->nodes_built();
  scaled_geometries_.erase(scaled_geometry);
}

void SceneQuery::reshape(std::uint32_t geometry, const Geometry& form) {
  meshes_[geometry] = build_mesh(form, scene_.tessellation);
  ++counters_.meshes_built;
  local_boxes_[geometry].reset();
  for (const std::uint32_t i : instances_of_geometry_.of(geometry)) {
    invalidate_box(i);
    if (!tight_boxes_.empty()) tight_boxes_[i].reset();
    if (!dops_.empty()) dops_[i].reset();
  }
  for (auto entry = scaled_geometries_.lower_bound({geometry, kLeastStretch});
       entry != scaled_geometries_.end() && entry->first.geometry == geometry;) {
    ScaledGeometry& scaled_geometry = *entry->second;
    Mat3 stretch;
    for (int i = 0; i < 9; ++i) stretch(i / 3, i % 3) = entry->first.stretch[static_cast<std::size_t>(i)];
    auto soup = make_soup(*meshes_[geometry], stretch);
    // Other polygons, or others cut otherwise, or none that are finite: it is made anew, or refused, when it is asked
    // for.
    if (soup && soup->faces == scaled_geometry.soup.faces && scaled_geometry.tree &&
        scaled_geometry.tree->refittable()) {
      scaled_geometry.soup = std::move(*soup);
      scaled_geometry.version = ++next_version_;
      scaled_geometry.tree->refit();
      ++counters_.hierarchies_refitted;
      ++entry;
      continue;
    }
    for (const std::uint32_t i : instances_of_geometry_.of(geometry)) {
      if (placed_[i].scaled_geometry == &scaled_geometry) placed_[i].scaled_geometry = nullptr;
    }
    erase_scaled_geometry(entry++);
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

const SceneQuery::Placed& SceneQuery::placed(std::uint32_t shape) {
  Placed& at = placed_[shape];
  if (at.known) return at;
  path_.clear();
  for (auto i = static_cast<std::int32_t>(shape); i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    const std::uint32_t t = scene_.instances[static_cast<std::size_t>(i)].transform;
    if (t != Instance::kNone) path_.push_back(transforms_[t]);
  }
  std::ranges::reverse(path_);
  const StretchedPose now = stretched_pose(path_);
  if (at.scaled_geometry != nullptr && now.stretch != at.at.stretch) {
    if (--at.scaled_geometry->use_count == 0) erase_scaled_geometry(scaled_geometries_.find(at.scaled_geometry->key));
    at.scaled_geometry = nullptr;
  }
  const Affine from = at.world_from_shape;
  at.at = now;
  at.world_from_shape = {multiply(now.pose.orientation.toRotationMatrix(), now.stretch), now.pose.position};
  at.updated_at = move_batch_;
  if (std::exchange(at.had_pose, true)) {
    at.displacement_m = displacement_bound_m(from, at.world_from_shape, local_box(scene_.instances[shape].geometry));
  }
  at.known = true;
  return at;
}

std::expected<SceneQuery::ScaledGeometry*, std::string> SceneQuery::scaled_geometry(std::uint32_t shape) {
  const Mat3& stretch = placed(shape).at.stretch;
  if (placed_[shape].scaled_geometry != nullptr) return placed_[shape].scaled_geometry;
  const std::uint32_t geometry = scene_.instances[shape].geometry;
  StretchKey key{geometry, {}};
  for (int i = 0; i < 9; ++i) key.stretch[static_cast<std::size_t>(i)] = stretch(i / 3, i % 3);
  auto known = scaled_geometries_.find(key);
  if (known == scaled_geometries_.end()) {
    auto soup = make_soup(mesh(geometry), stretch);
    if (!soup) return std::unexpected(scene_.path_of({shape}) + ": " + soup.error());
    ++counters_.soups_built;
    known =
        scaled_geometries_.emplace(key, std::make_unique<ScaledGeometry>(key, ++next_version_, std::move(*soup))).first;
  }
  placed_[shape].scaled_geometry = known->second.get();
  ++known->second->use_count;
  return known->second.get();
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
  std::string note = scene_.path_of({shape}) + ": hierarchyFile \"" + std::string(url) + "\" is not used: " + why;
  if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(std::move(note));
  return std::nullopt;
}

WideTree& SceneQuery::tree(std::uint32_t shape, ScaledGeometry& scaled_geometry) {
  if (scaled_geometry.tree) return *scaled_geometry.tree;
  scaled_geometry.tree = read_tree(shape, scaled_geometry.soup);
  if (!scaled_geometry.tree) {
    scaled_geometry.tree.emplace(scaled_geometry.soup);
    ++counters_.hierarchies_built;
  }
  return *scaled_geometry.tree;
}

std::expected<std::vector<SceneQuery::Baked>, std::string> SceneQuery::bake() {
  apply_moves();
  std::vector<Baked> files;
  std::map<std::string_view, const ScaledGeometry*> of_file;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const std::string_view url = scene_.shape({i}).hierarchy_file;
    if (url.empty() || !is_surface(i)) continue;
    const auto shape = scaled_geometry(i);
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
  const Placed& placed_shape = placed(shape);
  const Mat3& stretch = placed_shape.at.stretch;
  WorldBox box = transformed(placed_shape.world_from_shape, local);
  ++counters_.boxes_placed;
  if (box.is_empty()) return box;
  // The vertices that decide are rounded on other ways, to the other shape's frame; these all err by a few units in the
  // last place of the largest numbers on their way.
  double linear = 0.0, reach = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) linear = std::max(linear, std::abs(stretch(i, j)));
    reach = std::max({reach, std::abs(static_cast<double>(local.lo[i])), std::abs(static_cast<double>(local.hi[i]))});
  }
  const double pad = 0x1p-44 * (largest_coordinate(box) + 9.0 * linear * reach);
  // Where numbers overflow, it is to be looked at and refused, not passed over.
  if (!std::isfinite(pad)) return {Vec3::Constant(-kInfinity), Vec3::Constant(kInfinity)};
  for (int i = 0; i < 3; ++i) {
    box.lo[i] -= pad;
    box.hi[i] += pad;
  }
  return box;
}

// From the end of the subtree, so that no recursion is as deep as the scene.
const WorldBox& SceneQuery::box(std::uint32_t instance, Surfaces which) {
  auto& boxes = boxes_[static_cast<std::size_t>(which)];
  auto& other_boxes = boxes_[1 - static_cast<std::size_t>(which)];
  if (boxes[instance]) return *boxes[instance];
  for (std::uint32_t i = scene_.instances[instance].subtree_end; i-- > instance;) {
    if (boxes[i]) continue;
    WorldBox box;
    const std::uint32_t end = scene_.instances[i].subtree_end;
    if (is_surface(i, which)) {  // a Shape's box is the same whatever it is for
      const bool other = end == i + 1 && is_surface(i, Surfaces::kDrawn) && is_surface(i, Surfaces::kColliding);
      box = other && other_boxes[i] ? *other_boxes[i] : shape_box(i);
    }
    for (std::uint32_t child = i + 1; child < end; child = scene_.instances[child].subtree_end) {
      box.merge(*boxes[child]);
    }
    boxes[i] = box;
  }
  return *boxes[instance];
}

// Of the vertices that polygons use.
WorldBox SceneQuery::tight_shape_box(std::uint32_t shape) {
  const Mesh& m = mesh(scene_.instances[shape].geometry);
  const StretchedPose& at = placed(shape).at;
  const Mat3 rotation = at.pose.orientation.toRotationMatrix();
  const bool stretched = at.stretch != Mat3::Identity();
  std::vector<bool> used(m.vertices.size());
  for (const std::int32_t corner : m.corners) {
    if (corner != Mesh::kEndOfPolygon) used[static_cast<std::size_t>(corner)] = true;
  }
  WorldBox box;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Vec3 parsed = m.vertices[v].cast<double>();
    box.merge(Vec3(multiply(rotation, stretched ? multiply(at.stretch, parsed) : parsed) + at.pose.position));
    ++counters_.vertices_placed;
  }
  return box;
}

// Not beyond what broad phases are told, or they would pass over what it says.
WorldBox SceneQuery::realigned_shape_box(std::uint32_t shape) {
  const StretchedPose& at = placed(shape).at;
  dops_.resize(scene_.instances.size());
  std::optional<StretchedDop>& known = dops_[shape];
  if (!known || known->stretch != at.stretch) {
    known = {at.stretch, dop_of(mesh(scene_.instances[shape].geometry), at.stretch)};
  }
  WorldBox out = realigned_box(known->dop, at.pose);
  if (out.is_empty()) return out;
  const WorldBox& most = box(shape);
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = std::max(out.lo[k], most.lo[k]);
    out.hi[k] = std::min(out.hi[k], most.hi[k]);
  }
  return out;
}

void SceneQuery::set_box_bound(BoxBound bound) {
  box_bound_ = bound;
  tight_boxes_.clear();
}

std::expected<WorldBox, std::string> SceneQuery::tight_box(ObjectId object) {
  tight_boxes_.resize(scene_.instances.size());
  WorldBox box;
  for (std::uint32_t i = object.value; i < scene_.at(object).subtree_end; ++i) {
    if (!is_surface(i)) continue;
    std::optional<WorldBox>& of_shape = tight_boxes_[i];
    if (!of_shape) of_shape = box_bound_ == BoxBound::kVertices ? tight_shape_box(i) : realigned_shape_box(i);
    if (!finite(*of_shape))
      return std::unexpected(scene_.path_of({i}) + ": its vertices have no finite place in the world");
    box.merge(*of_shape);
  }
  return box;
}

SceneQueryCounters SceneQuery::counters() const {
  SceneQueryCounters out = counters_;
  out.queries = query_.counters();
  out.rays = rays_.counters();
  out.views = views_.counters();
  for (const auto& [key, scaled_geometry] : scaled_geometries_) {
    if (scaled_geometry->tree) out.nodes_built += scaled_geometry->tree->nodes_built();
  }
  return out;
}

}  // namespace peerd::collision
