#include "collision/scene/scene_meshes.hpp"

#include <cassert>

#include "core/geometry/tessellate.hpp"

namespace peerd::collision {

SceneMeshes::SceneMeshes(const Scene& scene)
    : scene_(scene), meshes_(scene.geometries.size()), local_boxes_(scene.geometries.size()) {}

const Mesh& SceneMeshes::mesh(std::uint32_t geometry) {
  assert(geometry < meshes_.size());
  std::optional<Mesh>& mesh = meshes_[geometry];
  if (!mesh) {
    mesh = build_mesh(scene_.geometries[geometry], scene_.tessellation);
    ++meshes_built_;
  }
  return *mesh;
}

const LocalBox& SceneMeshes::local_box(std::uint32_t geometry) {
  assert(geometry < local_boxes_.size());
  std::optional<LocalBox>& box = local_boxes_[geometry];
  if (!box) {
    box.emplace();
    for (const Eigen::Vector3f& v : mesh(geometry).vertices) box->merge(v);
  }
  return *box;
}

void SceneMeshes::reshape(std::uint32_t geometry, const Geometry& form) {
  assert(geometry < meshes_.size());
  meshes_[geometry] = build_mesh(form, scene_.tessellation);
  ++meshes_built_;
  local_boxes_[geometry].reset();
}

}  // namespace peerd::collision
