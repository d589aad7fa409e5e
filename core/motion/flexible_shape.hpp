#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/mesh.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// A Shape that is no rigid body as the world moves (flexible objects, Ohlenburg 2003, section 3.2.1): its Coordinate is
// driven, or a Transform above it is turned below an uneven scale, or has a driven scale. Its vertices are a function
// of world time, in the rigid frame of the carrier above it (carriers.hpp), or in the world.
class FlexibleShape {
 public:
  // The scene outlives it, at its place; `motion` is that of the scene, here and below. `carrier` is an instance above
  // the Shape.
  FlexibleShape(const Scene& scene, const PredefinedMotion& motion, ObjectId shape, std::optional<ObjectId> carrier);

  [[nodiscard]] ObjectId shape() const { return shape_; }

  // The mesh at world time t, in the frame of the Shape, and where that is in the frame of the carrier.
  [[nodiscard]] Mesh mesh(PredefinedMotion& motion, double t_s) const;
  [[nodiscard]] Affine carrier_from_shape(PredefinedMotion& motion, double t_s) const;

  // How the vertices move from t on, until end_s: bounds of their distance from the carrier's origin [m], of their
  // speeds [m/s] and of their accelerations [m/s^2]. The bounds hold for `h_s` at most.
  struct Course {
    double end_s = 0.0;
    double distance_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0;
  };
  [[nodiscard]] Course course(PredefinedMotion& motion, double t_s, double h_s) const;

 private:
  const Scene& scene_;
  ObjectId shape_;
  std::vector<ObjectId> transforms_;  // from below the carrier down
  Mat3 stretch_ = Mat3::Identity();   // of the carrier (StretchedPose)
  bool bends_ = false;                // its Coordinate is driven
  Mesh rigid_mesh_;                   // where it is not
};

}  // namespace peerd
