#pragma once
#include <iosfwd>
#include <string>

#include "peerd/input/world_file.hpp"

namespace peerd {

// `peerd bake WORLD.wrl` writes the file of each Shape that names a hierarchyFile, for `peerd collide` and for peers
// to map instead of building hierarchies. Returns the exit code: 0 good; 1 the world has errors, a Shape's vertices
// can't be used, or one file should hold two hierarchies; 2 there is no such world; 3 it, or a hierarchy file, can't be
// read or written.
//
// With `json` it prints one object to `out`: {"world", "files": [{"path", "bytes"}]}.
struct BakeOptions {
  WorldReading reading{};
  bool json = false;
};
[[nodiscard]] int run_bake(const std::string& path, const BakeOptions& options, std::ostream& out, std::ostream& err);

}  // namespace peerd
