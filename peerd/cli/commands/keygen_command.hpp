#pragma once
#include <filesystem>
#include <ostream>

namespace peerd {

// `peerd keygen` prints who this user is, for the administrator of a world, and makes that where there is none yet.
// Returns the exit code: 0; 2 the file is refused; 3 it can't be read or made.
struct KeygenOptions {
  std::filesystem::path identity;  // of --identity; empty: this user's own
};
[[nodiscard]] int run_keygen(const KeygenOptions& options, std::ostream& out);

}  // namespace peerd
