#include "peerd/store/durable_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "peerd/store/synchronise.hpp"

namespace peerd::store {
namespace {

// Writes and synchronises; returns 0, or an errno.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return fsync(fd) == 0 ? 0 : errno;
}

}  // namespace

Result<void> write_durably(const std::filesystem::path& file, std::string_view bytes) {
  const std::string unfinished = file.string() + ".new";
  const auto cannot = [&](int why) {
    unlink(unfinished.c_str());
    return std::unexpected(InputError{"error: " + file.string() + " cannot be written: " + std::strerror(why), 3});
  };
  const int fd = open(unfinished.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return cannot(errno);
  int failed = write_all(fd, bytes);
  if (close(fd) != 0 && failed == 0) failed = errno;
  if (failed == 0 && rename(unfinished.c_str(), file.c_str()) != 0) failed = errno;
  if (failed == 0) failed = synchronise(file.has_parent_path() ? file.parent_path() : ".").value();
  if (failed != 0) return cannot(failed);
  return {};
}

}  // namespace peerd::store
