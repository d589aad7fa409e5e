#include "peerd/daemon/log/standard_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

namespace peerd {

StandardOutput::~StandardOutput() {
  pollfd reader{is_socket_ ? STDOUT_FILENO : descriptor_, POLLOUT, 0};
  while (!give() && poll(&reader, 1, kPatience_ms) > 0) {
  }
  if (descriptor_ >= 0) close(descriptor_);
}

// Standard output may have become another file, as in a program that has itself run in the background.
void StandardOutput::open() {
  struct stat now {};
  if (fstat(STDOUT_FILENO, &now) != 0 || (now.st_dev == device_ && now.st_ino == inode_)) return;
  if (descriptor_ >= 0) close(descriptor_);
  device_ = now.st_dev;
  inode_ = now.st_ino;
  is_socket_ = S_ISSOCK(now.st_mode);
  const bool waits = S_ISFIFO(now.st_mode) || isatty(STDOUT_FILENO) != 0;
  descriptor_ = waits ? ::open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC) : -1;
  (void)std::fflush(stdout);  // what others have written stands before the first line
}

// Returns whether nothing waits any more.
bool StandardOutput::give() {
  while (given_ < waiting_.size()) {
    const char* const next = waiting_.data() + given_;
    const std::size_t size = waiting_.size() - given_;
    const ssize_t taken = is_socket_ ? send(STDOUT_FILENO, next, size, MSG_DONTWAIT) : ::write(descriptor_, next, size);
    if (taken < 0 && errno == EINTR) continue;
    if (taken < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return false;
    if (taken < 0) break;  // there is no reader; SIGPIPE says so
    given_ += static_cast<std::size_t>(taken);
  }
  waiting_.clear();
  given_ = 0;
  return true;
}

void StandardOutput::write(std::string_view line) {
  open();
  if (descriptor_ < 0 && !is_socket_) {
    (void)std::fwrite(line.data(), 1, line.size(), stdout);
    (void)std::fflush(stdout);
    return;
  }
  (void)give();
  if (waiting_.size() - given_ + line.size() > kWaiting_bytes) {
    ++dropped_;
    return;
  }
  waiting_.erase(0, given_);
  given_ = 0;
  waiting_ += line;
  (void)give();
}

std::uint64_t StandardOutput::take_dropped() { return dropped_ > 0 && give() ? std::exchange(dropped_, 0) : 0; }

}  // namespace peerd
