#pragma once
#include <fcntl.h>

namespace peerd::net {

// Keeps a socket or an acceptor of Asio from programs that this process runs. Asio opens and accepts sockets that they
// would inherit, and a port would be in use for as long as they run.
template <class Socket>
void close_on_exec(Socket& socket) {
  if (!socket.is_open()) return;
  const int flags = fcntl(socket.native_handle(), F_GETFD);
  if (flags >= 0) (void)fcntl(socket.native_handle(), F_SETFD, flags | FD_CLOEXEC);
}

}  // namespace peerd::net
