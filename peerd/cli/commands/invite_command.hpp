#pragma once
#include <filesystem>
#include <ostream>
#include <string>

namespace peerd {

// `peerd invite` prints the command that brings somebody else into a world: one line, as secret as the world's key, and
// advice to standard error. Where the world has a roster the line has that, and is good for its members alone. Returns
// the exit code: 0; 2 the key is refused; 3 this user has none of that world.
struct InviteOptions {
  std::string world;
  bool relay = false;         // print the key of a relay instead: what it needs to be greeted, and to read nothing
  std::filesystem::path key;  // of --key; empty: this user's own of the world
};
[[nodiscard]] int run_invite(const InviteOptions& options, std::ostream& out);

}  // namespace peerd
