#pragma once
#include <cassert>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/geometry.hpp"
#include "core/ids.hpp"
#include "core/lasting_ids.hpp"
#include "core/math.hpp"
#include "core/transform.hpp"

namespace peerd {

namespace vrml {
struct Document;
}

enum class NodeKind : std::uint8_t {
  kGroup,  // also Anchor
  kTransform,
  kBillboard,  // turns towards each viewer, so no peer's collisions turn it
  kCollision,
  kInline,
  kLod,
  kSwitch,
  kShape,
};

// Appendix C.2 of the thesis has CRT_INVERSE and CRT_ZERO; CRT_IMPULSE is ours.
enum class ResponseType : std::uint8_t { kInverse = 0, kZero = 1, kImpulse = 2 };

struct CollisionResponse {
  ResponseType type = ResponseType::kInverse;
  bool set_back = true;
  // The following members count for kImpulse alone.
  double mass_kg = 1.0;        // > 0
  double restitution = 1.0;    // 0 to 1: what is left of the speed at which two meet; of a pair the smaller counts
  double friction_m_s2 = 0.0;  // >= 0: deceleration with which it slides to rest; 0: none

  friend bool operator==(const CollisionResponse&, const CollisionResponse&) = default;
};

// The fields that appendix C.5 of the thesis adds to a Transform.
struct ObjectFields {
  Vec3 velocity = Vec3::Zero();       // velocityVector [m/s]
  double distance_threshold_m = 0.5;  // distanceThreshold
  bool enslaved = false;              // the founder of the session owns it, unless a configuration names an owner
  bool remote = false;                // its display converges where another peer owns it
  std::uint32_t layers = ~0u;         // collisionLayers: patterns pair two that share a bit
  std::optional<CollisionResponse> response;
};

// The fields that appendix C.4 of the thesis adds to a Shape.
struct ShapeFields {
  SharedArray<Eigen::Vector3f> convex_hull;
  std::string_view hierarchy_file;
  std::int32_t split_threshold = 10;
};

// An Instance is one node of the scene graph as it is instanced. Instances stand in depth-first order, so a subtree is
// the contiguous range [its own index, subtree_end). An index is the place in one Scene; an ObjectId lasts.
struct Instance {
  static constexpr std::uint32_t kNone = ~0u;

  std::string_view def;      // DEF name, may be empty; Scene::document keeps it
  std::int32_t parent = -1;  // index; -1 at the top level
  // The position among the children of the parent in the file, nodes that are no instance counted; the proxy of a
  // Collision stands behind its children.
  std::uint32_t child_index = 0;
  std::uint32_t subtree_end = 0;    // one past the last descendant
  std::uint32_t node = kNone;       // into Document::nodes
  std::uint32_t transform = kNone;  // into Scene::transforms, where it is a Transform
  std::uint32_t geometry = kNone;   // into Scene::geometries, where it is a Shape that has one
  std::uint32_t extension = kNone;  // into Scene::object_fields or shape_fields; none where all are the defaults
  NodeKind kind = NodeKind::kGroup;
  bool name_shadowed : 1 = false;  // find(def) finds another instance, so paths give the child index instead
  bool inner_name : 1 = false;  // `def` is a name of a PROTO's or an Inline's own: find() takes the world's before it
  // This is false where the standard takes the instance out of the world: below a child that a Switch has not chosen,
  // beyond level 0 of an LOD, in a Collision that does not collide, or stood for by its proxy.
  bool collides : 1 = true;
  // This is false where no viewer sees the instance: below a child that a Switch has not chosen, beyond level 0 of an
  // LOD, or in a proxy.
  bool drawn : 1 = true;
};

enum class CollisionType : std::uint8_t { kBox = 0, kWitness = 1, kAllPairs = 2 };  // the thesis, C.1
[[nodiscard]] constexpr const char* name_of(CollisionType type) {
  return type == CollisionType::kBox ? "box" : type == CollisionType::kWitness ? "witness" : "allpairs";
}

// A NamePattern is a path with a '*' in it, which stands for any characters of one name.
struct NamePattern {
  std::optional<ObjectId> below;  // what the names before the first '*' lead to; none: the path begins with the '*'
  std::string path;               // from the name with the first '*' on
};

// An InterestSide is the colliders or the collidees of a CollisionInterest. `ends` begins with those that the interest
// names, as it lists them; those that its patterns find follow in scene order.
struct InterestSide {
  std::vector<ObjectId> ends;  // each once
  std::size_t named = 0;       // how many of `ends`, from the front, are named
  std::vector<NamePattern> patterns;
};

// A CollisionInterest registers each of its colliders for each of its collidees.
struct CollisionInterest {
  InterestSide colliders, collidees;
  InterestSide except;  // what patterns leave out
  CollisionType type = CollisionType::kBox;
  std::uint32_t node = Instance::kNone;  // into Document::nodes
};

// A KeySensor (the thesis, C.3) changes the velocity of an object when a key is pressed.
struct KeySensor {
  std::uint32_t node = Instance::kNone;  // into Document::nodes
  std::optional<ObjectId> recipient;     // a Transform; none: it only tells other KeySensors
  std::int32_t key_value = 0;            // Qt::Key
  std::int32_t key_state = 0;            // Qt::ButtonState
  Vec3 value = Vec3::Zero();             // [m/s], in the frame of the recipient's parent
  std::string key_name;                  // a browser's name of the key, in place of the two; empty: they count
  bool on_release = false;               // works when the key goes up
  bool absolute = false;                 // `value` replaces the velocity, or is added to it
  bool consume = true;                   // no other KeySensor, nor the application, gets that event
  bool enabled = true;                   // at first
};

// A PendingInline is an Inline that has not been read: it says how large it is, nothing in it can collide, and the
// world was read with ReadOptions::defer_inlines.
struct PendingInline {
  ObjectId instance;
  Eigen::Vector3f box_center, box_size;  // [m], in the Inline's frame
  std::vector<std::string> urls;         // the first that can be read counts
  std::string base;                      // the name of the file that they are relative to
};

struct Scene {
  std::vector<Instance> instances;
  LastingIds<ObjectId> ids;  // of the instances
  std::vector<TransformFields> transforms;
  std::vector<Geometry> geometries;
  std::vector<ObjectFields> object_fields;
  std::vector<ShapeFields> shape_fields;
  std::vector<CollisionInterest> interests;
  std::vector<KeySensor> key_sensors;
  std::vector<PendingInline> pending_inlines;
  Tessellation tessellation;                       // fineness of all curved geometry
  std::shared_ptr<const vrml::Document> document;  // all fields of all nodes; names and arrays live in it

  [[nodiscard]] ObjectId id_of(std::uint32_t index) const { return ids.id_of(index); }
  [[nodiscard]] bool contains(ObjectId id) const { return ids.find(id, instances.size()).has_value(); }
  [[nodiscard]] std::uint32_t index_of(ObjectId id) const {  // of an instance that is there
    const auto index = ids.find(id, instances.size());
    assert(index && "it is an instance of this scene");
    return *index;
  }
  [[nodiscard]] const Instance& at(ObjectId id) const { return instances[index_of(id)]; }
  // Returns the instance above, if there is one.
  [[nodiscard]] std::optional<ObjectId> parent_of(ObjectId id) const;
  // Returns whether `inner` is `outer` or below it.
  [[nodiscard]] bool is_within(ObjectId inner, ObjectId outer) const;
  // These return the defaults where the node is no Transform, or no Shape.
  [[nodiscard]] const TransformFields& transform(ObjectId id) const;
  [[nodiscard]] const ObjectFields& object(ObjectId id) const;
  [[nodiscard]] const ShapeFields& shape(ObjectId id) const;
  [[nodiscard]] const Geometry* geometry(ObjectId id) const;  // null where there is none

  // Finds an instance by its path: DEF names, or child indices where there is none, joined by '/'; a lone DEF name
  // finds the first instance of that name, those inside PROTOs and Inlines last. Names may be quoted
  // (core/vrml/path_text.hpp). Linear in the instances.
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path) const;
  // Returns the path of an instance from the top level down, in the same notation; find() of it is that instance again.
  [[nodiscard]] std::string path_of(ObjectId id) const;

  // Returns the affine map from the frame of the children of an instance to the world: the product of the transforms of
  // its path, itself included.
  [[nodiscard]] Eigen::Affine3d world_from_local(ObjectId id) const;
  // Returns the rigid part of the path: the position of the origin of the instance and the product of the rotations of
  // its path. This is the pose that replication moves; scale and shear stay baked in the vertices of the object. The
  // position is world_from_local * 0: with a `center`, the origin is not at the translation, and it moves when the node
  // turns.
  [[nodiscard]] Pose rigid_pose(ObjectId id) const;
  // Returns the change of a translation in the world, for a vector in the frame of the parent of the instance, as a
  // velocityVector is.
  [[nodiscard]] Vec3 to_world(ObjectId id, const Vec3& in_parent) const;
  // Maps Shape-frame vertices of `shape` (a descendant of `object`, or itself) into the rigid frame of `object`:
  // rigid_pose(object)^-1 * world_from_local(shape). The map is exactly the identity where nothing but rigid transforms
  // lead to `object` and nothing at all from there to `shape`, so such vertices keep their parsed binary32 values.
  [[nodiscard]] Eigen::Affine3d object_from_shape(ObjectId object, ObjectId shape) const;
};

}  // namespace peerd
