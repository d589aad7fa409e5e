#include "peerd/input/user_folder.hpp"

#include <cstdlib>

namespace peerd {

std::optional<std::filesystem::path> user_folder(const char* variable, const std::filesystem::path& in_home) {
  const auto absolute = [](const char* name) {
    const char* const path = std::getenv(name);
    return path != nullptr && path[0] == '/' ? path : nullptr;
  };
  if (const char* const folder = absolute(variable)) return folder;
  if (const char* const home = absolute("HOME")) return std::filesystem::path(home) / in_home;
  return std::nullopt;
}

}  // namespace peerd
