#include "peerd/peer/control/control_client.hpp"

#include <optional>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>

#include "peerd/net/os/close_on_exec.hpp"

namespace peerd::control {

namespace asio = boost::asio;
using Protocol = asio::local::stream_protocol;
using boost::system::error_code;

namespace {

// Connects without waiting: connect() to a stopped peer with a full queue would block.
error_code connect(Protocol::socket& socket, const std::filesystem::path& path) {
  error_code error;
  socket.open(Protocol(), error);
  net::close_on_exec(socket);
  socket.non_blocking(true, error);
  socket.connect(Protocol::endpoint(path.string()), error);
  return error;
}

// Linux returns EAGAIN for a full queue, which Asio reports as no_buffer_space.
bool is_full_queue(const error_code& error) {
  return error == asio::error::would_block || error == asio::error::no_buffer_space;
}

std::unexpected<InputError> nobody_at(const std::filesystem::path& path, const std::string& why) {
  return std::unexpected(InputError{"error: no peer answers at " + path.string() + ": " + why, kSystemFailed});
}

Result<void> connect_to_peer(Protocol::socket& socket, const std::filesystem::path& path) {
  if (path.string().size() >= sizeof(sockaddr_un::sun_path))
    return nobody_at(path, "the path is too long for a socket's");
  const error_code error = connect(socket, path);
  if (error) return nobody_at(path, is_full_queue(error) ? "it is stopped, or busy" : error.message());
  return {};
}

}  // namespace

error_code reach(const std::filesystem::path& path) {
  if (path.string().size() >= sizeof(sockaddr_un::sun_path)) return asio::error::name_too_long;
  asio::io_context io(1);
  Protocol::socket socket(io);
  const error_code error = connect(socket, path);
  return is_full_queue(error) ? error_code() : error;
}

Result<std::string> ask(const std::filesystem::path& path, const std::string& request,
                        std::chrono::milliseconds within) {
  const auto nobody = [&](const std::string& why) { return nobody_at(path, why); };
  asio::io_context io(1);
  Protocol::socket socket(io);
  if (const auto connected = connect_to_peer(socket, path); !connected) return std::unexpected(connected.error());

  const std::string line = request + '\n';
  std::string reply;
  std::optional<error_code> done;
  // The write's result is ignored: a peer may refuse and close before it has read everything, and its reply counts.
  asio::async_write(socket, asio::buffer(line), [](const error_code&, std::size_t) {});
  asio::async_read_until(socket, asio::dynamic_buffer(reply), '\n',
                         [&](const error_code& failed, std::size_t size_bytes) {
                           done = failed;
                           if (!failed) reply.resize(size_bytes - 1);
                         });
  const auto give_up = std::chrono::steady_clock::now() + within;
  while (!done && io.run_one_until(give_up) > 0) {
  }
  if (!done) return nobody("it is silent for " + std::to_string(within.count()) + " ms");
  if (*done) return nobody(done->message());
  return reply;
}

Result<void> listen(const std::filesystem::path& path, const std::string& request,
                    const std::function<bool(const std::string& line)>& on_line) {
  asio::io_context io(1);
  Protocol::socket socket(io);
  if (const auto connected = connect_to_peer(socket, path); !connected) return std::unexpected(connected.error());
  error_code error;
  socket.non_blocking(false, error);
  if (!error) asio::write(socket, asio::buffer(request + '\n'), error);
  std::string bytes;
  for (bool first = true, more = true; more; first = false) {
    const std::size_t size_bytes = error ? 0 : asio::read_until(socket, asio::dynamic_buffer(bytes), '\n', error);
    if (error && first) return nobody_at(path, error.message());
    if (error) return {};
    more = on_line(bytes.substr(0, size_bytes - 1));
    bytes.erase(0, size_bytes);
  }
  return {};
}

}  // namespace peerd::control
