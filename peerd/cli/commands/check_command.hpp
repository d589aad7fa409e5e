#pragma once
#include <iosfwd>
#include <optional>
#include <string>

#include "peerd/input/world_file.hpp"

namespace peerd {

// `peerd check WORLD.wrl` prints the problems of the world as FILE:LINE:COLUMN with a caret to `err`, the first 20
// errors and the first 20 warnings with the number of the others; then its statistics, the defects of its polygons and
// what begins inside what to `out`. Returns the exit code: 0 good, 1 the world has errors, 2 there is no such file, 3
// it can't be read.
//
// With `json` it prints one object to `out` in place of both, with these keys whatever happens:
//   world        path as it was given
//   good         whether there is no error; the world may be good, and its copy not written
//   errors       [{file, line, column, message}], in the order of the texts; `file` is that of the Inline where the
//                error is in one. Lines and columns (bytes) count from 1; both are 0 where the file as a whole can't be
//                read.
//   warnings     [{file, line, column, message}] too
//   unsupported  [text]: requests of a good world that can't be answered: interests, or interests in or defects of more
//                than 2^25 polygons; with `at_s`, TimeSensors that have stopped for want of transitions
//   statistics   counts, which core/scene/scene_statistics.hpp defines. null unless good
//   defects      counts of polygons and of edges, which core/geometry/mesh_defects.hpp defines. `first` has for each
//                defect of polygons {shape, polygon}, or null where there is none; shape is null where no Shape has
//                that geometry. null unless good, and if `unsupported` says so
//   closed       [path]: the objects that interests name and whose surface is closed. null unless good
//   inside       [{inner, outer}]: the pairs that interests name of which one begins wholly inside the other, which is
//                closed. null unless good; both are empty where `unsupported` says that interests are not looked at
//   files        number of texts that were read: the world, its Inlines and EXTERNPROTOs
//   bytes        length of these texts, unpacked
//   read_ms      wall-clock time from opening the file to the scene
//   defects_ms   wall-clock time to find the defects; 0 where they are null
//   moving       with `at_s`: [{path, position, orientation}] of each Transform that the world itself moves, in the
//                world frame [m] and as a quaternion x y z w, when its TimeSensors are at that time
struct CheckOptions {
  WorldReading reading{};
  bool json = false;
  std::string copy;            // not empty: a good world is written there, as one text that needs no other
  std::optional<double> at_s;  // time at which the world's own movement is evaluated [s]
};
[[nodiscard]] int run_check(const std::string& path, const CheckOptions& options, std::ostream& out, std::ostream& err);

}  // namespace peerd
