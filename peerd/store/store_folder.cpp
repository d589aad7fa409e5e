#include "peerd/store/store_folder.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "peerd/store/operation_store.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;

// The first of `path`, `path`.2, `path`.3 and so on that fits.
template <class Fits>
fs::path first_of(const fs::path& path, Fits fits) {
  fs::path each = path;
  for (int number = 2; !fits(each); ++number) each = fmt::format("{}.{}", path.string(), number);
  return each;
}

}  // namespace

// XDG: a path that is not absolute is to be ignored.
std::optional<fs::path> state_folder() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && state[0] == '/') return fs::path(state) / "peerd";
  const char* const home = std::getenv("HOME");
  if (home == nullptr || home[0] != '/') return std::nullopt;
  return fs::path(home) / ".local" / "state" / "peerd";
}

std::optional<fs::path> default_folder(std::uint64_t genesis, const std::string& peer) {
  const auto state = state_folder();
  if (!state) return std::nullopt;
  std::string name = peer;
  std::ranges::replace(name, '/', '_');
  return first_of(*state / fmt::format("{:016x}", genesis) / name,
                  [](const fs::path& folder) { return !OperationStore::is_in_use(folder); });
}

Result<std::optional<fs::path>> put_aside(const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(folder, failed)) return std::nullopt;
  const auto cannot = [&](const std::string& why) {
    return std::unexpected(InputError{"error: the store " + folder.string() + " cannot be put aside: " + why, 3});
  };
  if (OperationStore::is_in_use(folder)) return cannot("it is in use by another process");
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  fs::path aside =
      first_of(named.string() + ".before", [&](const fs::path& path) { return !fs::exists(path, failed) || failed; });
  fs::rename(named, aside, failed);
  if (failed) return cannot(failed.message());
  return aside;
}

}  // namespace peerd::store
