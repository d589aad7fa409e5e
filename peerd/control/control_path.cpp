#include "peerd/control/control_path.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace peerd::api {

namespace fs = std::filesystem;

std::optional<fs::path> runtime_folder() {
  const char* folder = std::getenv("XDG_RUNTIME_DIR");
  if (folder == nullptr || folder[0] != '/') return std::nullopt;  // XDG: a path that is not absolute is to be ignored
  return fs::path(folder) / "peerd";
}

std::optional<fs::path> default_socket(const std::string& peer) {
  const auto folder = runtime_folder();
  return folder ? std::optional(*folder / (peer + ".sock")) : std::nullopt;
}

Result<fs::path> find_socket(const std::string& peer) {
  const auto folder = runtime_folder();
  if (!folder) {
    return std::unexpected(InputError{"error: which peer? XDG_RUNTIME_DIR is not set; say --control PATH"});
  }
  if (!peer.empty()) return *default_socket(peer);
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(*folder, none)) {
    if (entry.path().extension() == ".sock") names.push_back(entry.path().stem().string());
  }
  if (names.empty()) return std::unexpected(InputError{"error: no peer listens in " + folder->string(), 3});
  if (names.size() == 1) return *default_socket(names.front());
  std::ranges::sort(names);
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return std::unexpected(InputError{"error: which peer? Say --name NAME; there are " + all});
}

}  // namespace peerd::api
