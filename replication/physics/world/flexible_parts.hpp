#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "collision/exact/triangle_soup.hpp"
#include "core/motion/flexible_shape.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"
#include "replication/physics/world/world_model.hpp"

namespace peerd::replication {

// The flexible parts of a world as functions of session time: the same on all peers, without any message. Not
// thread-safe, as PredefinedMotion is not.
class FlexibleParts {
 public:
  // The model outlives it.
  explicit FlexibleParts(const WorldModel& model, std::optional<SimTime> world_zero = std::nullopt);

  // The session time at which world time began; none: everything is as the file has it. True where that changes.
  bool set_world_zero(std::optional<SimTime> zero);
  [[nodiscard]] std::optional<SimTime> world_zero() const { return zero_; }

  // A part as it stands at an instant, in the frame of its carrier.
  struct Form {
    std::vector<Vec3> vertices;
    std::vector<collision::TriangleSoup::Face> faces;
  };
  void form(std::uint32_t part, SimTime t, Form& out);

  // How the vertices move from t on, in the frame of the carrier: bounds that hold until `end`, and for h_s at most.
  struct Course {
    MotionBounds bounds;  // of distance, speed and acceleration
    std::optional<SimTime> end;
  };
  [[nodiscard]] Course course(std::uint32_t part, SimTime t, double h_s);

 private:
  [[nodiscard]] double world_s(SimTime t) const;

  PredefinedMotion motion_;
  std::vector<FlexibleShape> parts_;
  std::optional<SimTime> zero_;
};

}  // namespace peerd::replication
