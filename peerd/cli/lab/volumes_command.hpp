#pragma once
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "peerd/input/world_file.hpp"

namespace peerd {

// `peerd volumes WORLD.wrl` says of each Shape how much larger than its convex hull its bounding volumes are while it
// turns, and what its hierarchies of k-DOPs are like (the thesis, tables 3.1 to 3.3 and figures 3.1, 3.2 and 3.8).
// Problems of the world go to `err` as `peerd check` prints them. Returns the exit code: 0 good; 1 the world has
// errors, a Shape whose vertices can't be used, or nothing that collides; 2 there is no such file, or `hierarchies` are
// wrong; 3 it can't be read.
//
// With `json` it prints one object to `out`, which is that of error_json where there is no answer:
//   world      path as it was given
//   rotations  number of rotations of k-DOPs and boxes: seven full turns, around x, y, z, xy, xz, yz and xyz
//   shapes     by Shape in file order, an object of these:
//     path        "" with `whole`
//     polygons, triangles, vertices   counts; the vertices are those of the geometry, used or not
//     box         {lo, hi}: corners of the box of the vertices that polygons use, in the frame of the Shape [m]
//     hull        {corners, volume_m3}, of these vertices; null where they lie in one plane, and then so is `percent`
//     percent     volumes, % of the hull's: {"18-dop", aabb: {mean, least, greatest} over the rotations, obb, sphere}.
//                 18-DOP and AABB are around the turned hull, not realigned ones.
//     turned      with `curve`: [[18-DOP, AABB]] in %, by rotation
//     hierarchies [{k, rule, threshold, height, least_height, nodes, bytes, build_s, level_percent}], one for each of
//                 `hierarchies`: of triangles; `height` counts levels below the root, and `least_height` is that of a
//                 balanced tree of groups of `threshold` triangles; `bytes` are what queries need of nodes and order,
//                 shared by all instances; `build_s` is wall-clock time; `level_percent`, with `levels`, is the volume
//                 of each level with the leaves above it, % of the root's
struct VolumesOptions {
  WorldReading reading{};
  bool json = false;
  bool whole = false;  // all Shapes as one object, in the world frame
  bool curve = false;
  bool levels = false;
  std::uint32_t steps = 1000;              // of a full turn; at least 1
  std::vector<std::string> hierarchies{};  // each as "k=18,rule=splatter,threshold=4"
};
[[nodiscard]] int run_volumes(const std::string& path, const VolumesOptions& options, std::ostream& out,
                              std::ostream& err);

}  // namespace peerd
