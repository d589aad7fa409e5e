#pragma once
#include <iosfwd>
#include <string>

namespace peerd {

// `peerd check WORLD.wrl`: every problem of the world as FILE:LINE:COLUMN with a caret to `err`, then its statistics to
// `out`; with `json`, one JSON object to `out` in place of both. Returns the exit code: 0 good, 1 the world has errors,
// 2 there is no such file, 3 it can't be read.
[[nodiscard]] int run_check(const std::string& path, bool json, std::ostream& out, std::ostream& err);

}  // namespace peerd
