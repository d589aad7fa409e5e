#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/kinematics.hpp"

// Bodies at places where gravity holds them, by chance: on, in and between things, anywhere and of any size.
namespace peerd::stress {

struct PlacedObject {
  std::string name;
  KinematicState state;
};

struct RestingPlace {
  std::string what;   // for messages
  std::string world;  // VRML97, without its first line; its numbers are exact in binary32, and all poses are below
  std::vector<PlacedObject> supports;
  std::vector<PlacedObject> bodies;  // their acceleration is gravity
  double gap_m = 0.0;                // what each body is away from what bears it, at most
  double size_m = 1.0;               // of the bodies
  double coordinate_m = 0.0;         // no coordinate is larger
};

// Spheres, boxes and meshes over a box, two triangles, a seam, in a wedge, in a corner, and over another resting body:
// equilibria, but for the gap of 0 to 1e-6 m. Sizes are 1e-3 to 1e3 m, coordinates up to 1e7 m, restitution is below 1.
[[nodiscard]] RestingPlace make_resting_place(std::uint64_t seed);

}  // namespace peerd::stress
