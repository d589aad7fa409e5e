#pragma once
#include <filesystem>
#include <set>

// This program's fsync(2) notes what it is called for, and fails where a test says so. SQLite uses it, too.
namespace peerd::testing_support {

class WatchedFsync {
 public:
  WatchedFsync();
  ~WatchedFsync();
  WatchedFsync(const WatchedFsync&) = delete;
  WatchedFsync& operator=(const WatchedFsync&) = delete;

  // Calls for this file or folder fail with EIO from now on; none for an empty path.
  void fail(std::filesystem::path path);
  // The files that have been synchronised since this object was made.
  [[nodiscard]] std::set<std::filesystem::path> done() const;
};

}  // namespace peerd::testing_support
