#pragma once
#include <iosfwd>
#include <string>

#include "peerd/input/world_file.hpp"

namespace peerd {

// `peerd export WORLD.wrl --gltf FILE` writes what a viewer draws of a world at an instant, as its own motion has it
// then, as glTF 2.0 binary, and says what is left out. Problems of the world go to `err` as `peerd check` prints them.
// Returns the exit code: 0 good, 1 the world has errors, 2 there is no such file, 3 it can't be read, or FILE written.
//
// With `json` it prints one object to `out`, which is that of error_json where nothing is written:
//   world, time_s   path as it was given, and the instant
//   file, bytes     what was written
//   nodes           how many move by themselves, and one for all that stands
//   shapes, meshes, triangles, images, lights, viewpoints
//                   how many there are; a mesh serves all Shapes that have it, and the triangles are those of all
//                   Shapes
//   undrawn         [{path, what, why, count}]: what is left out, or drawn otherwise than the standard says
struct ExportOptions {
  WorldReading reading{};
  bool json = false;
  std::string gltf;   // the file
  double at_s = 0.0;  // TimeSensor time [s]; velocityVectors have moved their objects since 0
};
[[nodiscard]] int run_export(const std::string& path, const ExportOptions& options, std::ostream& out,
                             std::ostream& err);

}  // namespace peerd
