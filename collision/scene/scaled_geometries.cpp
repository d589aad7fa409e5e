#include "collision/scene/scaled_geometries.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "collision/exact/infinity.hpp"
#include "collision/tree/hierarchy_file.hpp"

namespace peerd::collision {
namespace {

// The least key of a geometry in the order of the map: no stretch has an infinite number.
constexpr std::array<double, 9> kLeastStretch = [] {
  std::array<double, 9> least{};
  least.fill(-kInfinity);
  return least;
}();

}  // namespace

ScaledGeometries::ScaledGeometries(const Scene& scene, HierarchyLoader load_hierarchy)
    : scene_(scene), load_hierarchy_(std::move(load_hierarchy)) {}

std::expected<ScaledGeometry*, std::string> ScaledGeometries::acquire(std::uint32_t geometry, const Mat3& stretch,
                                                                      SceneMeshes& meshes) {
  ScaledGeometry::Key key{geometry, {}};
  for (int i = 0; i < 9; ++i) key.stretch[static_cast<std::size_t>(i)] = stretch(i / 3, i % 3);
  auto known = by_key_.find(key);
  if (known == by_key_.end()) {
    auto soup = make_soup(meshes.mesh(geometry), stretch);
    if (!soup) return std::unexpected(soup.error());
    ++counters_.soups_built;
    known = by_key_.emplace(key, std::make_unique<ScaledGeometry>(key, ++next_version_, std::move(*soup))).first;
  }
  ++known->second->use_count;
  return known->second.get();
}

void ScaledGeometries::release(ScaledGeometry& scaled_geometry) {
  assert(scaled_geometry.use_count > 0);
  if (--scaled_geometry.use_count > 0) return;
  const auto entry = by_key_.find(scaled_geometry.key);
  assert(entry != by_key_.end() && entry->second.get() == &scaled_geometry);
  erase(entry);
}

void ScaledGeometries::erase(ByKey::iterator entry) {
  if (entry->second->tree) counters_.nodes_built += entry->second->tree->nodes_built();
  by_key_.erase(entry);
}

void ScaledGeometries::reshape(std::uint32_t geometry, const Mesh& mesh,
                               const std::function<void(const ScaledGeometry&)>& dropped) {
  for (auto entry = by_key_.lower_bound({geometry, kLeastStretch});
       entry != by_key_.end() && entry->first.geometry == geometry;) {
    ScaledGeometry& scaled_geometry = *entry->second;
    Mat3 stretch;
    for (int i = 0; i < 9; ++i) stretch(i / 3, i % 3) = entry->first.stretch[static_cast<std::size_t>(i)];
    auto soup = make_soup(mesh, stretch);
    const bool same_faces = soup && soup->faces == scaled_geometry.soup.faces;
    if (same_faces && scaled_geometry.tree && scaled_geometry.tree->refittable()) {
      scaled_geometry.soup = std::move(*soup);
      scaled_geometry.version = ++next_version_;
      scaled_geometry.tree->refit();
      ++counters_.hierarchies_refitted;
      ++entry;
      continue;
    }
    // The polygons are others, are cut in another way, or have vertices that are not finite: the geometry is made anew,
    // or refused, when an instance asks for it.
    dropped(scaled_geometry);
    erase(entry++);
  }
}

WideTree& ScaledGeometries::tree(ObjectId shape, ScaledGeometry& scaled_geometry) {
  assert(!scaled_geometry.soup.faces.empty());
  if (scaled_geometry.tree) return *scaled_geometry.tree;
  scaled_geometry.tree = read_tree(shape, scaled_geometry.soup);
  if (!scaled_geometry.tree) {
    scaled_geometry.tree.emplace(scaled_geometry.soup);
    ++counters_.hierarchies_built;
  }
  return *scaled_geometry.tree;
}

std::optional<WideTree> ScaledGeometries::read_tree(ObjectId shape, const TriangleSoup& soup) {
  const std::string_view url = scene_.shape(shape).hierarchy_file;
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
  std::string note = scene_.path_of(shape) + ": hierarchyFile \"" + std::string(url) + "\" is not used: " + why;
  if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(std::move(note));
  return std::nullopt;
}

ScaledGeometries::Counters ScaledGeometries::counters() const {
  Counters out = counters_;
  for (const auto& [key, scaled_geometry] : by_key_) {
    if (scaled_geometry->tree) out.nodes_built += scaled_geometry->tree->nodes_built();
  }
  return out;
}

}  // namespace peerd::collision
