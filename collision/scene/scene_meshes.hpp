#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/box.hpp"
#include "core/geometry/mesh.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// The meshes of a scene's geometries, each tessellated when a question first needs it. Geometries are named by their
// index in Scene::geometries, and coordinates are in the Shape's frame [m], as parsed.
class SceneMeshes {
 public:
  explicit SceneMeshes(const Scene& scene);  // the scene outlives it, at its place

  [[nodiscard]] const Mesh& mesh(std::uint32_t geometry);
  // The box of all vertices of the mesh, including those that no polygon uses: there are fewer vertices than corners.
  [[nodiscard]] const LocalBox& local_box(std::uint32_t geometry);
  // Gives a geometry another form.
  void reshape(std::uint32_t geometry, const Geometry& form);

  [[nodiscard]] std::uint64_t meshes_built() const { return meshes_built_; }

 private:
  const Scene& scene_;
  std::vector<std::optional<Mesh>> meshes_;           // by geometry
  std::vector<std::optional<LocalBox>> local_boxes_;  // by geometry
  std::uint64_t meshes_built_ = 0;
};

}  // namespace peerd::collision
