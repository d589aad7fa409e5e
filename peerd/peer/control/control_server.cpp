#include "peerd/peer/control/control_server.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/control_client.hpp"
#include "peerd/peer/control/pending_lines.hpp"
#include "peerd/peer/control/request.hpp"

namespace peerd::control {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using boost::system::error_code;
using Protocol = asio::local::stream_protocol;

constexpr std::chrono::seconds kAcceptAgainAfter{1};  // pause after a failure, such as a lack of descriptors

std::unexpected<InputError> cannot_listen(const fs::path& path, const std::string& why, int code = kSystemFailed) {
  return std::unexpected(InputError{"error: can't listen for control at " + path.string() + ": " + why, code});
}

// A lock that is held while a stale socket is checked and replaced, so that of two peers that start at once the second
// finds the first. It is a file beside the socket that only this user may open: a lock on a shared folder could be held
// for ever by any user. Its holder removes it, so that a lock counts only if the file still stands there.
class LockFile {
 public:
  explicit LockFile(fs::path path) : path_(std::move(path)) {
    for (int tries = 0; !held_ && tries < 100; ++tries) {
      if (tries > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (!try_to_hold()) return;
    }
  }
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;
  ~LockFile() {
    if (held_) unlink(path_.c_str());
    if (fd_ >= 0) close(fd_);
  }
  [[nodiscard]] bool held() const { return held_; }

 private:
  // Returns whether another try makes sense.
  bool try_to_hold() {
    if (fd_ >= 0) close(fd_);
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0600);
    struct stat locked {};
    if (fd_ < 0 || fstat(fd_, &locked) != 0 || !S_ISREG(locked.st_mode) || locked.st_uid != geteuid()) return false;
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0) return true;
    struct stat standing {};
    held_ =
        lstat(path_.c_str(), &standing) == 0 && standing.st_dev == locked.st_dev && standing.st_ino == locked.st_ino;
    return true;
  }

  fs::path path_;
  int fd_ = -1;
  bool held_ = false;
};

// Removes the socket of a dead peer at `path`.
Result<void> clear(const fs::path& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) {
    if (errno == ENOENT) return {};
    return cannot_listen(path, error_code(errno, boost::system::system_category()).message());
  }
  if (!S_ISSOCK(found.st_mode)) return cannot_listen(path, "something that is no socket stands there", 2);
  const error_code error = reach(path);
  if (!error) return cannot_listen(path, "another peer listens there; give each its own");
  if (error != asio::error::connection_refused) return cannot_listen(path, error.message());
  if (unlink(path.c_str()) != 0) {
    return cannot_listen(path, error_code(errno, boost::system::system_category()).message());
  }
  return {};
}

// Whether this user or the system's administrator has connected: somebody may have changed the mode of the socket's
// file, or passed a descriptor of it on.
bool is_of_this_user(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  return peer.uid == geteuid() || peer.uid == 0;
}

}  // namespace

// The io_context may hold clients and handlers that outlive the server; `over_` tells them.
class ControlServer::Impl : public std::enable_shared_from_this<Impl> {
 public:
  Impl(asio::io_context& io, fs::path path, Answerer answer)
      : io_(io), path_(std::move(path)), answer_(std::move(answer)), acceptor_(io), again_(io) {}

  Result<void> listen() {
    const LockFile lock(path_.string() + ".lock");
    if (!lock.held()) {
      return cannot_listen(path_,
                           path_.string() + ".lock can't be made, is not this user's, or is held by another program");
    }
    if (auto cleared = clear(path_); !cleared) return cleared;
    error_code error;
    acceptor_.open(Protocol(), error);
    net::close_on_exec(acceptor_);
    // The file of a socket gets the mode of its descriptor, so that other users cannot connect at any time.
    if (!error && fchmod(acceptor_.native_handle(), 0600) != 0) error = {errno, boost::system::system_category()};
    if (!error) acceptor_.bind(Protocol::endpoint(path_.string()), error);
    if (!error) acceptor_.listen(kClientsMax, error);
    struct stat made {};
    if (!error && lstat(path_.c_str(), &made) != 0) error = {errno, boost::system::system_category()};
    if (error) return cannot_listen(path_, error.message());
    file_ = {made.st_dev, made.st_ino};
    accept();
    return {};
  }

  void close() {
    over_ = true;
    error_code ignored;
    acceptor_.close(ignored);
    again_.cancel();
    for (const auto& client : std::exchange(clients_, {})) client->close();
    struct stat found {};
    const bool ours =
        file_.second != 0 && lstat(path_.c_str(), &found) == 0 && std::pair(found.st_dev, found.st_ino) == file_;
    if (ours) unlink(path_.c_str());
  }

  [[nodiscard]] const Counters& counters() const { return counters_; }

  [[nodiscard]] EventKinds wanted() const { return wanted_; }

  void publish(EventKind kind, const std::string& line) {
    assert(line.find('\n') == std::string::npos);
    if (!wanted_.contains(kind)) return;
    for (const ClientPtr& client : std::vector<ClientPtr>(clients_.begin(), clients_.end())) {
      if (client->wanted.contains(kind)) give(client, line);
    }
  }

 private:
  struct Client {
    explicit Client(Protocol::socket s) : socket(std::move(s)), deadline(socket.get_executor()) {}
    void close() {
      error_code ignored;
      socket.close(ignored);
      deadline.cancel();
    }
    Protocol::socket socket;
    asio::steady_timer deadline;
    std::string in;
    PendingLines out;
    std::string writing;  // the first line of `out`, with its end, while its rest is being written
    bool writes = false;
    EventKinds wanted{};
    bool last = false;  // the connection closes after this reply
  };
  using ClientPtr = std::shared_ptr<Client>;

  void accept() {
    acceptor_.async_accept([self = shared_from_this()](const error_code& error, Protocol::socket socket) {
      if (self->over_) return;
      if (error) return self->accept_later();
      self->take(std::move(socket));
      self->accept();
    });
  }

  void accept_later() {
    again_.expires_after(kAcceptAgainAfter);
    again_.async_wait([self = shared_from_this()](const error_code&) {
      if (!self->over_) self->accept();
    });
  }

  void take(Protocol::socket socket) {
    net::close_on_exec(socket);
    error_code error;
    socket.non_blocking(true, error);
    const auto client = std::make_shared<Client>(std::move(socket));
    if (error) return;
    ++counters_.clients;
    if (!is_of_this_user(client->socket.native_handle())) {
      ++counters_.strangers;
      return client->close();
    }
    const bool full = clients_.size() >= kClientsMax;
    if (full) {
      ++counters_.refused;
      const std::string line = refusal("this peer has " + std::to_string(kClientsMax) + " clients already") + '\n';
      client->socket.write_some(asio::buffer(line), error);  // the line fits into the buffer of a new socket
      return client->close();
    }
    clients_.insert(client);
    read(client);
  }

  void read(const ClientPtr& client) {
    asio::async_read_until(client->socket, asio::dynamic_buffer(client->in, kLineMax_bytes), '\n',
                           [self = shared_from_this(), client](const error_code& error, std::size_t size_bytes) {
                             self->on_read(client, error, size_bytes);
                           });
  }

  void on_read(const ClientPtr& client, const error_code& error, std::size_t size_bytes) {
    if (!clients_.contains(client)) return;
    if (error == asio::error::not_found) {  // no line end within the limit, so later requests cannot be separated
      ++counters_.too_long;
      client->last = true;
      return reply(client, refusal("a request may have " + std::to_string(kLineMax_bytes) + " bytes"));
    }
    if (error) return drop(client);  // an unfinished line at the end of the stream is not a request
    ++counters_.requests;
    const std::string line = client->in.substr(0, size_bytes - 1);
    client->in.erase(0, size_bytes);
    Answer answer = answer_(line);
    if (!clients_.contains(client)) return;
    if (answer.subscribe) {
      client->wanted = *answer.subscribe;
      find_wanted();
    }
    if (answer.line.empty()) return read(client);
    reply(client, std::move(answer.line));
  }

  // The part of the reply that fits leaves at once, so that the reply to "leave" is out before the peer leaves; the
  // rest has a time limit. The client's next request is read only after its reply is out, so that one reply waits for
  // each client.
  void reply(const ClientPtr& client, std::string line) {
    assert(line.find('\n') == std::string::npos);
    client->out.add_reply(std::move(line));
    write(client);
    if (!clients_.contains(client) || !client->out.has_reply()) return;
    client->deadline.expires_after(kReplyWithin);
    client->deadline.async_wait([self = shared_from_this(), client](const error_code& cancelled) {
      if (cancelled || !self->clients_.contains(client)) return;
      ++self->counters_.too_slow;
      self->drop(client);
    });
  }

  void give(const ClientPtr& client, const std::string& line) {
    if (client->out.add_event(line)) {
      write(client);
    } else {
      ++counters_.events_dropped;
    }
  }

  // Writes what the socket takes, and the rest when it takes more.
  void write(const ClientPtr& client) {
    while (clients_.contains(client) && !client->writes && !client->out.empty()) {
      client->writing = client->out.front().text + '\n';
      error_code error;
      const std::size_t written = client->socket.write_some(asio::buffer(client->writing), error);
      if (error && error != asio::error::would_block && error != asio::error::try_again) return drop(client);
      if (written == client->writing.size()) {
        wrote(client);
        continue;
      }
      client->writes = true;
      asio::async_write(client->socket, asio::buffer(client->writing) + written,
                        [self = shared_from_this(), client](const error_code& failed, std::size_t) {
                          if (!self->clients_.contains(client)) return;
                          client->writes = false;
                          if (failed) return self->drop(client);
                          self->wrote(client);
                          self->write(client);
                        });
    }
  }

  void wrote(const ClientPtr& client) {
    if (!client->out.take_front().is_reply) return;
    client->deadline.cancel();
    replied(client);
  }

  void replied(const ClientPtr& client) {
    if (client->last) return drop(client);
    read(client);
  }

  void find_wanted() {
    wanted_ = {};
    for (const ClientPtr& client : clients_) wanted_.add(client->wanted);
  }

  void drop(const ClientPtr& client) {
    clients_.erase(client);
    if (!client->wanted.empty()) find_wanted();
    client->close();
  }

  asio::io_context& io_;
  fs::path path_;
  Answerer answer_;
  Protocol::acceptor acceptor_;
  asio::steady_timer again_;
  std::set<ClientPtr> clients_;
  EventKinds wanted_;               // by some client
  std::pair<dev_t, ino_t> file_{};  // identifies our socket: close() leaves another one at the same path alone
  bool over_ = false;
  Counters counters_;
};

ControlServer::ControlServer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

ControlServer::~ControlServer() { impl_->close(); }

EventKinds ControlServer::wanted() const { return impl_->wanted(); }

void ControlServer::publish(EventKind kind, const std::string& line) { impl_->publish(kind, line); }

const ControlServer::Counters& ControlServer::counters() const { return impl_->counters(); }

Result<std::unique_ptr<ControlServer>> ControlServer::open(asio::io_context& io, const fs::path& path,
                                                           Answerer answer) {
  constexpr std::size_t kPathMax_bytes = sizeof(sockaddr_un::sun_path) - 1;
  if (path.string().size() > kPathMax_bytes) {
    return cannot_listen(path, "a socket's path may have " + std::to_string(kPathMax_bytes) + " bytes", 2);
  }
  auto impl = std::make_shared<Impl>(io, path, std::move(answer));
  if (auto listening = impl->listen(); !listening) return std::unexpected(listening.error());
  return std::unique_ptr<ControlServer>(new ControlServer(std::move(impl)));
}

}  // namespace peerd::control
