#include "tests/peerd/peer/store/watched_fsync.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>

namespace peerd::testing_support {
namespace {

struct Watch {
  std::mutex mutex;
  int watchers = 0;
  std::filesystem::path fails;
  std::set<std::filesystem::path> done;
};
Watch& watch() {
  static Watch one;
  return one;
}

bool note(int file) {
  std::error_code failed;
  const auto path = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), failed);
  Watch& all = watch();
  const std::lock_guard lock(all.mutex);
  if (all.watchers == 0 || failed) return true;
  if (!all.fails.empty() && path == all.fails) return false;
  all.done.insert(path);
  return true;
}

}  // namespace

WatchedFsync::WatchedFsync() {
  const std::lock_guard lock(watch().mutex);
  ++watch().watchers;
  watch().done.clear();
  watch().fails.clear();
}
WatchedFsync::~WatchedFsync() {
  const std::lock_guard lock(watch().mutex);
  --watch().watchers;
}
void WatchedFsync::fail(std::filesystem::path path) {
  const std::lock_guard lock(watch().mutex);
  watch().fails = std::move(path);
}
std::set<std::filesystem::path> WatchedFsync::done() const {
  const std::lock_guard lock(watch().mutex);
  return watch().done;
}

}  // namespace peerd::testing_support

extern "C" int fsync(int file) {
  if (peerd::testing_support::note(file)) return static_cast<int>(::syscall(SYS_fsync, file));
  errno = EIO;
  return -1;
}
