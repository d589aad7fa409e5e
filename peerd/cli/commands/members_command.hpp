#pragma once
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace peerd {

// `peerd members` lists the members of a world, begins their roster, and changes it. Returns the exit code: 0; 1 the
// roster is damaged; 2 wrong use, or not allowed; 3 a file can't be read or written.
struct MembersOptions {
  std::string world{};
  std::filesystem::path roster{};    // of --roster; empty: this user's own of the world
  std::filesystem::path identity{};  // of --identity; empty: this user's own
  std::string begin{};               // the name of the first administrator, who this user is; empty: none
  std::vector<std::string> add{};    // NAME=KEY
  std::string role = "editor";       // of those that are added
  std::vector<std::string> remove{};
  bool json = false;
};
[[nodiscard]] int run_members(const MembersOptions& options, std::ostream& out);

}  // namespace peerd
