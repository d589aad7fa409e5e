#include "peerd/peer/control/control_path.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "peerd/peer/control/control_client.hpp"

namespace peerd::control {
namespace {

namespace fs = std::filesystem;

fs::path socket_of(const std::string& peer) { return runtime_folder() / (peer + ".sock"); }

// The names of the peers that listen in the folder of default sockets. Sockets of dead peers don't count.
std::vector<std::string> listening() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(runtime_folder(), none)) {
    if (entry.path().extension() == ".sock" && !reach(entry.path())) names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

fs::path runtime_folder() {
  const char* folder = std::getenv("XDG_RUNTIME_DIR");
  // XDG: a path that is not absolute is to be ignored.
  if (folder != nullptr && folder[0] == '/') return fs::path(folder) / "peerd";
  const std::string user = std::to_string(geteuid());
  const fs::path of_user = fs::path("/run/user") / user;
  struct stat found {};
  const bool is_ours = stat(of_user.c_str(), &found) == 0 && found.st_uid == geteuid();
  return is_ours ? of_user / "peerd" : fs::path("/tmp") / ("peerd-" + user);
}

// /tmp is open to all users: a folder there may be somebody else's.
Result<void> make_runtime_folder() {
  const fs::path folder = runtime_folder();
  const auto cannot = [&](const std::string& why) {
    return std::unexpected(InputError{"error: can't make the folder " + folder.string() + ": " + why, kSystemFailed});
  };
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return cannot(std::error_code(errno, std::generic_category()).message());
  }
  struct stat found {};
  if (lstat(folder.c_str(), &found) != 0) return cannot(std::error_code(errno, std::generic_category()).message());
  if (!S_ISDIR(found.st_mode)) return cannot("something else stands there");
  if (found.st_uid != geteuid()) return cannot("it is another user's");
  if ((found.st_mode & (S_IWGRP | S_IWOTH)) != 0) return cannot("other users may write to it");
  return {};
}

fs::path default_socket(const std::string& name, std::uint32_t id) {
  const fs::path usual = socket_of(name);
  return reach(usual) ? usual : socket_of(name + "-" + std::to_string(id));
}

Result<fs::path> find_socket(const std::string& peer) {
  const std::vector<std::string> names = listening();
  if (peer.empty() && names.size() == 1) return socket_of(names.front());
  if (std::ranges::find(names, peer) != names.end()) return socket_of(peer);
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  if (names.empty()) {
    const std::string who = peer.empty() ? "no peer" : "no peer " + peer;
    return std::unexpected(InputError{"error: " + who + " listens in " + runtime_folder().string() +
                                          "; is it another user's, or has it a socket of its own (--control PATH)?",
                                      3});
  }
  if (peer.empty()) return std::unexpected(InputError{"error: which peer? Say --name NAME; there are " + all});
  return std::unexpected(InputError{"error: no peer " + peer + " listens; there are " + all, kSystemFailed});
}

std::vector<fs::path> all_sockets() {
  std::vector<fs::path> all;
  for (const std::string& name : listening()) all.push_back(socket_of(name));
  return all;
}

}  // namespace peerd::control
