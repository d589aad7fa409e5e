#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collision/exact/triangle_soup.hpp"
#include "collision/scene/scene_meshes.hpp"
#include "collision/tree/wide_tree.hpp"
#include "core/scene/scene.hpp"

namespace peerd::collision {

// A file in memory, at an address that is a multiple of 64.
struct MappedFile {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
};
// Maps the file that a Shape's hierarchyFile names. It answers nothing where there is no such file, and in a few words
// why a file can't be read.
using HierarchyLoader = std::function<std::expected<std::optional<MappedFile>, std::string>(std::string_view url)>;

// A geometry as it is scaled for collision: all instances with the same geometry and stretch share one.
struct ScaledGeometry {
  struct Key {
    std::uint32_t geometry = 0;
    std::array<double, 9> stretch{};  // StretchedPose::stretch, row by row
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  Key key;
  std::uint64_t version = 0;  // a number that was never used before, whenever the vertices are others; > 0
  TriangleSoup soup;
  std::optional<WideTree> tree{};
  std::size_t use_count = 0;  // instances that hold it
};

// The scaled geometries of a scene, with their hierarchies: each is made when an instance first asks for it, and
// forgotten when the last instance that holds it is scaled in another way.
class ScaledGeometries {
 public:
  // Without a loader no hierarchyFile is read. The scene outlives this object, at its place.
  ScaledGeometries(const Scene& scene, HierarchyLoader load_hierarchy);

  // The geometry with that stretch, held by one instance more. The error is make_soup()'s.
  [[nodiscard]] std::expected<ScaledGeometry*, std::string> acquire(std::uint32_t geometry, const Mat3& stretch,
                                                                    SceneMeshes& meshes);
  // One instance holds it no more; after the last one, the reference is invalid.
  void release(ScaledGeometry& scaled_geometry);

  // A geometry's mesh is another one from now on. Where only vertices moved, the hierarchy is refitted; all other
  // scaled geometries of it are forgotten, each after a call of `dropped`.
  void reshape(std::uint32_t geometry, const Mesh& mesh, const std::function<void(const ScaledGeometry&)>& dropped);

  // The hierarchy, read from the Shape's hierarchyFile if that fits, else begun now. The soup has a face.
  [[nodiscard]] WideTree& tree(ObjectId shape, ScaledGeometry& scaled_geometry);

  [[nodiscard]] std::size_t size() const { return by_key_.size(); }
  // The hierarchyFiles that were refused, each with its Shape and the reason.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  struct Counters {
    std::uint64_t soups_built = 0;           // geometries triangulated
    std::uint64_t hierarchies_built = 0;     // hierarchies begun; nodes_built says how far
    std::uint64_t hierarchies_read = 0;      // hierarchies taken from their files
    std::uint64_t hierarchies_refitted = 0;  // hierarchies that followed moved vertices
    std::uint64_t nodes_built = 0;           // nodes of all hierarchies that there ever were
  };
  [[nodiscard]] Counters counters() const;

 private:
  using ByKey = std::map<ScaledGeometry::Key, std::unique_ptr<ScaledGeometry>>;
  void erase(ByKey::iterator entry);
  [[nodiscard]] std::optional<WideTree> read_tree(ObjectId shape, const TriangleSoup& soup);

  const Scene& scene_;
  HierarchyLoader load_hierarchy_;
  ByKey by_key_;
  std::uint64_t next_version_ = 0;
  std::vector<std::string> notes_;
  Counters counters_;  // nodes_built counts hierarchies that are no more
};

}  // namespace peerd::collision
