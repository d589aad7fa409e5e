#include "peerd/peer/store/synchronise.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace peerd::store {

namespace fs = std::filesystem;

std::error_code synchronise(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {errno, std::generic_category()};
  const std::error_code failed =
      ::fsync(file) == 0 ? std::error_code() : std::error_code(errno, std::generic_category());
  ::close(file);
  return failed;
}

std::error_code put_in_place(const fs::path& unfinished, const fs::path& file) {
  if (const auto failed = synchronise(unfinished)) return failed;
  std::error_code failed;
  fs::rename(unfinished, file, failed);
  if (failed) return failed;
  return synchronise(file.has_parent_path() ? file.parent_path() : fs::path("."));
}

// A folder whose name is not on the disk is lost with all that is in it, however well that is written.
std::error_code make_folders(const fs::path& folder) {
  std::error_code failed;
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  if (fs::is_directory(named, failed)) return {};
  const fs::path above = named.has_parent_path() ? named.parent_path() : fs::path(".");
  if (named != above) {
    if (const auto above_failed = make_folders(above)) return above_failed;
  }
  failed.clear();
  fs::create_directory(named, failed);
  if (failed == std::errc::file_exists) return std::make_error_code(std::errc::not_a_directory);
  if (failed) return failed;
  return synchronise(above);
}

}  // namespace peerd::store
