#include "peerd/cli/shell/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

namespace peerd {

void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is this stream's, since those below it are taken. The direction is the wrong one, so that
    // each use of the stream fails with EBADF, as it would with the stream closed.
    (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

std::optional<std::string> why_output_is_lost() {
  errno = 0;
  std::cout.flush();
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::cout.good() && std::ferror(stdout) == 0) return std::nullopt;
  if (errno == EBADF) return "it is closed";
  return errno != 0 ? std::strerror(errno) : "an earlier write failed";
}

}  // namespace peerd
