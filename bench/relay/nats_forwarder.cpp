#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "bench/relay/forwarders.hpp"

namespace peerd::bench {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

bool is_installed() { return std::system("command -v nats-server >/dev/null 2>&1") == 0; }

std::uint16_t free_port() {
  asio::io_context io;
  const tcp::acceptor any(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
  return any.local_endpoint().port();
}

// Speaks the protocol of NATS, which is lines of text: INFO, CONNECT, SUB, PUB, MSG, PING and PONG.
class NatsForwarder final : public Forwarder {
 public:
  NatsForwarder(std::size_t sinks, std::size_t datagram_bytes) : port_(free_port()) {
    const std::string size = std::to_string(datagram_bytes);
    publish_ = "PUB peerd.r0 " + size + "\r\n";
    message_ = "MSG peerd.r0 1 " + size + "\r\n";
    frame_bytes_ = message_.size() + datagram_bytes + 2;
    start();
    for (std::size_t i = 0; i <= sinks; ++i) connect(i > 0);
  }
  ~NatsForwarder() override {
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  // The first number of schedstat is nanoseconds on a processor.
  double cpu_s() const override {
    double ns = 0.0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(server_) + "/task")) {
      std::ifstream schedstat(task.path() / "schedstat");
      double of_thread = 0.0;
      if (schedstat >> of_thread) ns += of_thread;  // a thread may end meanwhile
    }
    return ns / 1e9;
  }
  void send(const std::vector<std::vector<std::byte>>& datagrams) override {
    std::string out;
    for (const auto& datagram : datagrams) {
      out += publish_;
      out.append(reinterpret_cast<const char*>(datagram.data()), datagram.size());
      out += "\r\n";
    }
    asio::write(connections_.front()->socket, asio::buffer(out));
  }
  std::size_t receive(std::size_t sink, std::vector<std::byte>& all) override {
    Connection& from = *connections_[1 + sink];
    boost::system::error_code ec;
    std::array<char, 65536> chunk{};
    for (;;) {
      const std::size_t got = from.socket.read_some(asio::buffer(chunk), ec);
      if (ec == asio::error::would_block) break;
      if (ec) throw std::runtime_error("nats-server closes a connection: " + ec.message());
      from.waiting.append(chunk.data(), got);
    }
    std::size_t datagrams = 0, at = 0;
    while (from.waiting.size() - at >= frame_bytes_) {
      if (from.waiting.compare(at, 4, "PING") == 0) {
        asio::write(from.socket, asio::buffer(std::string("PONG\r\n")));
        at += 6;
        continue;
      }
      if (from.waiting.compare(at, message_.size(), message_) != 0) throw std::runtime_error("nats-server says else");
      const auto* const payload = reinterpret_cast<const std::byte*>(from.waiting.data()) + at + message_.size();
      all.insert(all.end(), payload, payload + frame_bytes_ - message_.size() - 2);
      at += frame_bytes_;
      ++datagrams;
    }
    from.waiting.erase(0, at);
    return datagrams;
  }

 private:
  struct Connection {
    explicit Connection(asio::io_context& io) : socket(io) {}
    tcp::socket socket;
    std::string waiting;
  };

  void start() {
    server_ = fork();
    if (server_ != 0) return;
    run_on(kForwardersCore);
    setenv("GOMAXPROCS", "1", 1);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    const std::string port = std::to_string(port_);
    execlp("nats-server", "nats-server", "-a", "127.0.0.1", "-p", port.c_str(), nullptr);
    _exit(127);
  }
  void connect(bool subscribes) {
    auto made = std::make_unique<Connection>(io_);
    boost::system::error_code ec;
    for (int tries = 0; tries < 500; ++tries) {
      made->socket.connect({asio::ip::address_v4::loopback(), port_}, ec);
      if (!ec) break;
      made->socket.close();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (ec) throw std::runtime_error("nats-server does not start");
    made->socket.set_option(tcp::no_delay(true));
    asio::streambuf line;
    asio::read_until(made->socket, line, "\r\n");
    std::string hello = "CONNECT {\"verbose\":false,\"pedantic\":false}\r\n";
    if (subscribes) hello += "SUB peerd.r0 1\r\n";
    asio::write(made->socket, asio::buffer(hello + "PING\r\n"));
    asio::streambuf pong;
    asio::read_until(made->socket, pong, "PONG\r\n");
    made->socket.non_blocking(subscribes);
    connections_.push_back(std::move(made));
  }

  asio::io_context io_;
  std::uint16_t port_;
  pid_t server_ = -1;
  std::string publish_, message_;
  std::size_t frame_bytes_ = 0;
  std::vector<std::unique_ptr<Connection>> connections_;
};

}  // namespace

std::unique_ptr<Forwarder> nats_forwarder(std::size_t sinks, std::size_t datagram_bytes) {
  if (!is_installed()) return nullptr;
  return std::make_unique<NatsForwarder>(sinks, datagram_bytes);
}

}  // namespace peerd::bench
