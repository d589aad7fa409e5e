#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/math.hpp"

// This header holds the scenes of many bodies that the benchmark `crowd` gives to peerd and to physics engines.
namespace peerd::bench {

// kGas: boxes fly in a closed room. kPile: boxes fall on a floor. kStanding: a gas of which kMovers boxes move, and the
// others stand as if nailed down.
enum class CrowdKind { kGas, kPile, kStanding };
inline constexpr std::size_t kMovers = 100;

// A box of 1 m and 1 kg.
struct CrowdBody {
  Vec3 place, velocity;  // [m], [m/s]; y is up
  bool moves = true;
};

// All may meet all, but for two that stand; nothing turns. Without friction and loss in a gas; in a pile with gravity,
// without restitution, and with friction where the engine has any.
struct CrowdScene {
  CrowdKind kind;
  double side_m = 0.0;  // of the room, a cube about the origin; a pile has none
  std::vector<CrowdBody> bodies;
};

inline constexpr double kGravity_m_s2 = 9.81;

// 3 m apart on average; the same for the same number.
[[nodiscard]] CrowdScene gas_of(std::size_t bodies);
[[nodiscard]] CrowdScene pile_of(std::size_t bodies);
[[nodiscard]] CrowdScene standing_of(std::size_t bodies);

// The six walls of a room, or the floor: centres and half sizes [m].
struct CrowdWall {
  Vec3 centre, half;
};
[[nodiscard]] std::vector<CrowdWall> walls_of(const CrowdScene& scene);

// The bodies are B0, B1, ..
[[nodiscard]] std::string world_text(const CrowdScene& scene);

// A CrowdState is what a check of a crowd finds at an instant.
struct CrowdState {
  double energy_j = 0.0;                         // of motion
  double deepest_m = 0.0, deepest_wall_m = 0.0;  // of two bodies, of a body and a wall; 0: none is in anything
  std::size_t outside = 0;                       // bodies with their centre beyond a wall
};
struct CrowdPose {
  Vec3 place, velocity;
};
[[nodiscard]] CrowdState state_of(const CrowdScene& scene, const std::vector<CrowdPose>& bodies);

}  // namespace peerd::bench
