#pragma once
#include <iosfwd>
#include <optional>
#include <string>

namespace peerd {

// `peerd check WORLD.wrl`: the problems of the world as FILE:LINE:COLUMN with a caret to `err`, the first 20 errors and
// the first 20 warnings with the number of the others; then its statistics and the defects of its polygons to `out`.
// Returns the exit code: 0 good, 1 the world has errors, 2 there is no such file, 3 it can't be read.
//
// With `json`, one object to `out` in place of both, with these keys whatever happens:
//   world        the path as it was given
//   good         whether there is no error
//   errors       [{file, line, column, message}], in the order of the texts; `file` is the Inline's where it's there.
//                Lines and columns (bytes) count from 1; both are 0 where the file as a whole can't be read.
//   warnings     likewise
//   unsupported  [text]: what can't be answered of a good world: interests, or interests in or defects of more than
//   2^25
//                polygons; with `at_s`, TimeSensors that have stopped for want of transitions
//   statistics   counts; core/scene/scene_statistics.hpp says of what. null unless good
//   defects      counts of polygons and of edges; core/geometry/mesh_defects.hpp says of which. `first` has for each
//   defect of
//                polygons {shape, polygon}, or null where there is none; shape is null where no Shape has that
//                geometry. null unless good, and if `unsupported` says so
//   files        texts that were read: the world, its Inlines and EXTERNPROTOs
//   bytes        of them, unpacked
//   read_ms      wall clock, from opening the file to the scene
//   defects_ms   likewise, to find the defects; 0 where they are null
//   moving       with `at_s`: [{path, position, orientation}] of each Transform that the world itself moves, in the
//                world frame [m] and as a quaternion x y z w, when its TimeSensors are at that time
struct CheckOptions {
  bool json = false;
  std::string copy;            // not empty: a good world is written there, as one text that needs no other
  std::optional<double> at_s;  // where the world's own movement has brought things by then [s]
};
[[nodiscard]] int run_check(const std::string& path, const CheckOptions& options, std::ostream& out, std::ostream& err);

}  // namespace peerd
