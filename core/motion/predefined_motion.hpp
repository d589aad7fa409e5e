#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/animation/animation.hpp"
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// PredefinedMotion is the movement that a world makes by itself: TimeSensors, interpolators and ROUTEs, and the
// velocityVectors of Transforms, as a function of world time (the time of its TimeSensors) and of nothing else, so that
// all peers see the same without any message. World time before 0 is before the world was read: everything is where its
// file puts it. A velocityVector moves a translation from world time 0 on (Ohlenburg 2003, equation C.1), unless a
// ROUTE drives that translation.
//
// The cost is zero for a world without a TimeSensor that has a ROUTE, and without a velocityVector. A question costs as
// much as its own instance depends on. Questions are not const, since they remember what is known about chains of
// TimeSensors. Not thread-safe.
class PredefinedMotion {
 public:
  explicit PredefinedMotion(const Scene& scene);  // the scene outlives it

  // Returns whether the place of the instance in the world moves by itself: its own Transform or one above it is
  // driven.
  [[nodiscard]] bool moves(ObjectId id) const;
  // Returns whether the instance moves in its parent: its own Transform is driven.
  [[nodiscard]] bool moves_in_parent(ObjectId id) const;
  // Returns whether the movement of the instance in its parent turns it, or changes its scale.
  [[nodiscard]] bool turns_in_parent(ObjectId id) const;
  [[nodiscard]] bool scales(ObjectId id) const;
  // Returns whether a velocityVector moves the instance in its parent.
  [[nodiscard]] bool drifts(ObjectId id) const { return !velocity_of(id).isZero(0.0); }
  // Returns whether everything below the instance stays one rigid body of one shape: nothing strictly below it is
  // driven, no scale of its path is, and no driven rotation stands below an uneven scale, which would shear it ever
  // differently.
  [[nodiscard]] bool stays_rigid(ObjectId id) const;
  // The driven instances in depth-first order, each once.
  [[nodiscard]] const std::vector<ObjectId>& driven_transforms() const { return driven_ids_; }

  [[nodiscard]] std::vector<animation::FieldId> fields_of(ObjectId id) const;  // driven fields

  // Returns the fields of a Transform at world time t.
  [[nodiscard]] TransformFields transform(ObjectId id, double t_s);
  [[nodiscard]] Pose rigid_pose(ObjectId id, double t_s);
  // Returns Scene::to_world() as the parent of the instance stands at world time t.
  [[nodiscard]] Vec3 to_world(ObjectId id, const Vec3& in_parent, double t_s);

  // The geometries whose vertices move: IndexedFaceSets whose Coordinate is driven, by index into Scene::geometries.
  [[nodiscard]] std::vector<std::uint32_t> flexible_geometries() const;
  // Evaluates one driven geometry at world time t. Points that the event has no value for stay where the file has them.
  [[nodiscard]] Geometry geometry(std::uint32_t index, double t_s);

  // The Transform of an instance at t, and how fast its fields move until end_s > t: translation and center [m/s],
  // rotation and scaleOrientation [rad/s], scale [1/s].
  struct FieldRates {
    TransformFields fields;
    double end_s = 0.0;
    double translation_m_s = 0.0, center_m_s = 0.0, rotation_rad_s = 0.0, scale_orientation_rad_s = 0.0,
           scale_1_s = 0.0;
  };
  [[nodiscard]] FieldRates field_rates(ObjectId id, double t_s);
  // Whether the vertices of a driven geometry move at t, and until when that stays so, or they move evenly.
  struct VertexSpan {
    bool moves = false;
    double end_s = 0.0;
  };
  [[nodiscard]] VertexSpan vertex_span(std::uint32_t geometry, double t_s);

  // Describes how the rigid pose of an instance goes on from t, in the rigid frame of an instance above it (none: in
  // the world), whose scale and shear are as in the file. From begin_s until end_s, begin_s <= t < end_s, it is
  // advance(state, s - begin_s) at world time s, but for a circle: where `turning_rad_s` is not 0, the acceleration
  // turns by that rate. One driven translation, or its own driven rotation, or both, are exactly so between two keys,
  // circles for kCircle_s. Anything else (a driven rotation above it, a driven center or scale) is cut into pieces of
  // kPiece_s on a grid of world time. Such a piece goes through the true pose at both ends and the true position in the
  // middle, and is off by about |jerk| * kPiece_s^3 / 125 in between: 1e-5 m for a point on a circle of 10 m radius
  // that turns once a second. Where keys are closer together than kPiece_s the movement is cut in this way too, so that
  // a file cannot make work without end.
  struct Piece {
    double begin_s = 0.0, end_s = 0.0;
    KinematicState state;
    Vec3 turning_rad_s = Vec3::Zero();  // in the frame of `state`
  };
  static constexpr double kPiece_s = 0x1p-7;
  static constexpr double kCircle_s = 4.0;
  [[nodiscard]] Piece piece(ObjectId id, double t_s, std::optional<ObjectId> above = std::nullopt);

  // Returns the time since when TimeSensors that start each other stand still, because they have used up what one world
  // may (see animation::AnimationOptions), as far as the motion has been evaluated.
  [[nodiscard]] std::optional<double> transition_limit_reached_at() const {
    return animation_ ? animation_->transition_limit_reached_at() : std::nullopt;
  }
  [[nodiscard]] animation::Animation* animation() { return animation_ ? &*animation_ : nullptr; }

 private:
  enum Part : std::uint8_t { kTranslation, kRotation, kScale, kScaleOrientation, kCenter };
  struct Driven {
    std::uint32_t transform = 0;  // into Scene::transforms
    Part part = kTranslation;
    animation::FieldId field;
  };
  // The path of a question: the instances from below `above` down to the one in question, and what scales and shears
  // the first of them.
  struct Way {
    std::vector<std::uint32_t> instances;
    Mat3 stretch = Mat3::Identity();
  };

  void read_routes();
  [[nodiscard]] std::span<const Driven> driven(std::uint32_t transform) const;
  // The driven part of an instance; null where it is not driven.
  [[nodiscard]] const Driven* driven_part(ObjectId id, Part part) const;
  // The velocityVector [m/s, in the parent's frame], where it moves the instance.
  [[nodiscard]] Vec3 velocity_of(ObjectId id) const;
  [[nodiscard]] bool is_evenly_scaled_above(ObjectId id) const;
  [[nodiscard]] Way way_to(ObjectId id, std::optional<ObjectId> above) const;
  [[nodiscard]] Pose pose_on(const Way& way, double t_s);
  static void set_part(TransformFields& fields, Part part, const Vec3& vector, const Quat& rotation);

  const Scene& scene_;
  std::optional<animation::Animation> animation_;
  std::vector<Driven> driven_;  // indexed by transform
  std::vector<ObjectId> driven_ids_;
  std::vector<std::pair<std::uint32_t, animation::FieldId>> flexible_;  // geometry, points; by geometry
  animation::Value value_;                                              // scratch
};

}  // namespace peerd
