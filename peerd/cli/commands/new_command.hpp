#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>

namespace peerd {

// `peerd new FOLDER` begins a world of somebody's own: a small world and a scenario of two peers in it, both explained
// by comments. It prints to `out` what to try next. Returns 0; 2 where the name can't be one, or a file of that name
// is there; 3 where the files can't be written.
struct NewOptions {
  std::filesystem::path folder;
  std::string name;  // of both files and of the world; empty: the folder's own
  // A world's file of any format. The folder gets a copy of it and of the files that it names, with a side file
  // (WORLD.peerd.toml) that shows what can be said of it. Empty: a small world is begun.
  std::filesystem::path from;
};
[[nodiscard]] int run_new(const NewOptions& options, std::ostream& out);

}  // namespace peerd
