#include "peerd/peer/store/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "peerd/peer/store/synchronise.hpp"

namespace peerd::store {
namespace {

namespace fs = std::filesystem;

LockError failure(int error) { return {LockError::Why::kFailed, std::strerror(error)}; }

// Whether the path names what is open as `file`.
bool is_still_named(const fs::path& path, int file) {
  struct stat opened {
  }, named{};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

}  // namespace

std::expected<FolderLock, LockError> FolderLock::take(const fs::path& folder, Making making) {
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (making == Making::kFolders) {
      if (const auto failed = make_folders(folder)) {
        return std::unexpected(LockError{LockError::Why::kFailed, failed.message()});
      }
    }
    const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) {
      if (errno == ENOENT && making == Making::kFolders) continue;  // another process has renamed it just now
      return std::unexpected(errno == ENOENT ? LockError{LockError::Why::kMissing, {}} : failure(errno));
    }
    FolderLock lock(folder, file);
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      return std::unexpected(errno == EWOULDBLOCK ? LockError{LockError::Why::kInUse, {}} : failure(errno));
    }
    // Between the two calls its last user may have put it aside: what has the name now is another folder.
    if (is_still_named(folder, file)) return lock;
  }
  return std::unexpected(LockError{LockError::Why::kFailed, "other processes rename it again and again"});
}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(file_, other.file_);
  return *this;
}

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace peerd::store
