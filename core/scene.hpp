#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"

namespace peerd {

struct SourceLocation {
  std::uint32_t line = 0;    // from 1
  std::uint32_t column = 0;  // from 1, in bytes
};

// The polygons of one geometry node, in its Shape's frame. Stored once however often it is USEd.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;     // [m], the parsed binary32 values
  std::vector<std::uint32_t> polygon_begin;  // polygons + 1 offsets into `indices`; a polygon has >= 3 corners
  std::vector<std::uint32_t> indices;        // into `vertices`
  bool ccw = true;                           // corners run counter-clockwise seen from the front
  SourceLocation where;

  [[nodiscard]] std::size_t polygon_count() const { return polygon_begin.empty() ? 0 : polygon_begin.size() - 1; }
};

enum class NodeKind : std::uint8_t { kGroup, kTransform, kShape };

// VRML97 6.52: p_parent = T * C * R * SR * S * SR^-1 * C^-1 * p_local.
struct TransformFields {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();
  Quat scale_orientation = Quat::Identity();
  Vec3 center = Vec3::Zero();
};

enum class ResponseType : std::uint8_t { kInverse = 0, kZero = 1 };  // seed, C.2: CRT_INVERSE, CRT_ZERO

struct CollisionResponse {
  ResponseType type = ResponseType::kInverse;
  bool set_back = true;
};

// One node of the scene graph as it is instanced. Instances stand in depth-first file order, so a subtree is the
// contiguous range [its own index, subtree_end).
struct Instance {
  NodeKind kind = NodeKind::kGroup;
  std::string def;           // DEF name, may be empty
  std::int32_t parent = -1;  // index; -1 at the top level
  std::uint32_t child_index =
      0;                       // position among the parent's children in the file, nodes that are no instance counted
  bool name_shadowed = false;  // find(def) finds another instance, so paths give the child index instead
  std::uint32_t subtree_end = 0;     // one past the last descendant
  TransformFields transform;         // identity unless kTransform
  std::int32_t mesh = -1;            // into Scene::meshes; -1 unless a kShape with polygons
  std::string unsupported_geometry;  // the geometry node's type where this reader keeps but does not tessellate it
  SourceLocation where;
  // Seed appendix C.5 (Transform) and C.4 (Shape)
  Vec3 velocity = Vec3::Zero();       // velocityVector [m/s]
  double distance_threshold_m = 0.5;  // distanceThreshold
  std::optional<CollisionResponse> response;
  std::vector<Eigen::Vector3f> convex_hull;
  std::string hierarchy_file;
  std::int32_t split_threshold = 10;
};

enum class CollisionType : std::uint8_t { kBox = 0, kWitness = 1, kAllPairs = 2 };  // seed, C.1

struct CollisionInterest {
  ObjectId collider;
  std::vector<ObjectId> collidees;
  CollisionType type = CollisionType::kBox;
  SourceLocation where;
};

struct Scene {
  std::vector<Instance> instances;  // index == ObjectId::value
  std::vector<Mesh> meshes;
  std::vector<CollisionInterest> interests;

  [[nodiscard]] const Instance& at(ObjectId id) const { return instances.at(id.value); }

  // An instance by its path: DEF names, or child indices where there is none, joined by '/'; a lone DEF name finds the
  // first instance of that name. Linear in the instances.
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path) const;
  // The path of an instance from the top level down, in the same notation; find() of it is that instance again.
  [[nodiscard]] std::string path_of(ObjectId id) const;

  // Affine map from an instance's own children frame to world: the product of the transforms of its path, itself
  // included.
  [[nodiscard]] Eigen::Affine3d world_from_local(ObjectId id) const;
  // The rigid part of the path: the position of the instance's origin and the product of its path's rotations. This is
  // the pose that replication moves; scale and shear stay baked in the object's vertices. The position is
  // world_from_local * 0: with a `center`, the origin is not at the translation, and it moves when the node turns.
  [[nodiscard]] Pose rigid_pose(ObjectId id) const;
  // Maps Shape-frame vertices of `shape` (a descendant of `object`, or itself) into the rigid frame of `object`:
  // rigid_pose(object)^-1 * world_from_local(shape). Exactly the identity where nothing but rigid transforms lead to
  // `object` and nothing at all from there to `shape`, so such vertices keep their parsed binary32 values.
  [[nodiscard]] Eigen::Affine3d object_from_shape(ObjectId object, ObjectId shape) const;
};

}  // namespace peerd
