#pragma once
#include <expected>
#include <functional>
#include <optional>
#include <string>

#include "core/math.hpp"

namespace peerd::view {

// The sizes of who walks, as NavigationInfo's avatarSize has them (VRML97, 6.29) [m].
struct AvatarSize {
  double radius_m = 0.25;  // it comes no nearer to a wall
  double height_m = 1.6;   // of its eye above the ground
  double step_m = 0.75;    // what is no higher it steps on, and passes under nothing of it
};

struct Stride {
  Vec3 eye = Vec3::Zero();  // where it is [m, world]
  Vec3 by = Vec3::Zero();   // where it wants to go from there [m]; where it `falls`, without the vertical part
  bool falls = true;        // else it flies
  double fall_m_s = 0;      // its speed downwards so far
  double for_s = 0;         // the time in which it falls
};

struct Stand {
  Vec3 eye = Vec3::Zero();
  bool on_ground = false;  // of one that falls
  double fall_m_s = 0;
};

struct RayHit {
  double distance_m = 0;
  Vec3 normal = Vec3::Zero();  // towards the ray's side
};
// A caster says what a ray of unit direction meets first; its error, what cannot be asked.
using CastResult = std::expected<std::optional<RayHit>, std::string>;
using RayCaster = std::function<CastResult(const Vec3& origin, const Vec3& direction)>;

// Returns where the stride ends: at walls, along which it slides with what is left of it, up steps and down to the
// ground. Walls are felt by rays at three heights and three places across the way, so that what is thinner than the
// gaps between them may be passed. Where nothing is below, nobody falls.
[[nodiscard]] std::expected<Stand, std::string> walk(const RayCaster& cast, const AvatarSize& size,
                                                     const Stride& stride);

}  // namespace peerd::view
