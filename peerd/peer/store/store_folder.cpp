#include "peerd/peer/store/store_folder.hpp"

#include <algorithm>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/user_folder.hpp"
#include "peerd/peer/store/disk_folder.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/store_error.hpp"
#include "peerd/peer/store/synchronise.hpp"

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

// A name in the folder that no store puts there; empty: there is none.
Result<std::string> foreign_in(const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator each(folder, failed), end; !failed && each != end; each.increment(failed)) {
    std::string name = each->path().filename().string();
    if (!OperationStore::is_own_file(name)) return name;
  }
  if (failed) return std::unexpected(store_error(folder, "cannot be put aside: " + failed.message(), 3));
  return std::string();
}

}  // namespace

std::optional<fs::path> state_folder() {
  const auto state = user_folder("XDG_STATE_HOME", ".local/state");
  if (!state) return std::nullopt;
  return *state / "peerd";
}

std::optional<fs::path> default_folder(std::uint64_t genesis, const std::string& peer) {
  const auto state = state_folder();
  if (!state) return std::nullopt;
  std::string name = peer;
  std::ranges::replace(name, '/', '_');
  if (name.empty() || name == "." || name == "..") name += "_";  // these would be other folders
  return *state / fmt::format("{:016x}", genesis) / name;
}

Result<FolderLock> lock_folder(const fs::path& folder) {
  auto lock = FolderLock::take(folder, FolderLock::Making::kFolders);
  if (lock) return *std::move(lock);
  if (lock.error().why == LockError::Why::kInUse) return std::unexpected(in_use(folder));
  return std::unexpected(store_error(folder, "cannot be used: " + lock.error().text, 3));
}

Result<FolderLock> lock_first_free(const fs::path& folder) {
  std::expected<FolderLock, LockError> lock = std::unexpected(LockError{});
  const fs::path free = first_of(folder, [&](const fs::path& each) {
    lock = FolderLock::take(each, FolderLock::Making::kFolders);
    return lock || lock.error().why != LockError::Why::kInUse;
  });
  if (lock) return *std::move(lock);
  return std::unexpected(store_error(free, "cannot be used: " + lock.error().text, 3));
}

Result<std::optional<fs::path>> put_aside(FolderLock lock) {
  const DiskFolder locked(std::move(lock));
  const fs::path& folder = locked.path();
  const auto cannot = [&](const std::string& why) {
    return std::unexpected(store_error(folder, "cannot be put aside: " + why, 3));
  };
  std::error_code failed;
  const bool is_empty = fs::is_empty(folder, failed);
  if (failed) return cannot(failed.message());
  if (is_empty) return std::nullopt;
  const auto foreign = foreign_in(folder);
  if (!foreign) return std::unexpected(foreign.error());
  if (!foreign->empty()) {
    return std::unexpected(InputError{
        "error: " + folder.string() + " is not put aside, because it has what is of no store: " + *foreign, 2});
  }
  if (const auto good = OperationStore::check_file(locked); !good && good.error().exit_code == 2) {
    return std::unexpected(good.error());
  }
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  fs::path aside =
      first_of(named.string() + ".before", [&](const fs::path& path) { return !fs::exists(path, failed) || failed; });
  fs::rename(named, aside, failed);
  if (!failed) failed = synchronise(named.has_parent_path() ? named.parent_path() : fs::path("."));
  if (failed) return cannot(failed.message());
  return aside;
}

}  // namespace peerd::store
