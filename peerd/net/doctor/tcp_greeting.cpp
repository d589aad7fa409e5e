#include "peerd/net/doctor/tcp_greeting.hpp"

#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <utility>

namespace peerd::doctor {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr TcpGreeting kGreeting{'p', 'e', 'e', 'r', 'd', '=', '\1', '\n'};
constexpr std::chrono::seconds kWithin{3};

// One accepted connection: it keeps itself until its greeting was answered, or the io_context ends.
struct Accepted : std::enable_shared_from_this<Accepted> {
  explicit Accepted(tcp::socket taken) : socket(std::move(taken)) {}
  void answer() {
    asio::async_read(socket, asio::buffer(greeting), [self = shared_from_this()](error_code ec, std::size_t) {
      if (ec || self->greeting != kGreeting) return;
      asio::async_write(self->socket, asio::buffer(kGreeting), [self](error_code, std::size_t) {});
    });
  }
  tcp::socket socket;
  TcpGreeting greeting{};
};

}  // namespace

GreetingListener::GreetingListener(asio::io_context& io, const tcp::endpoint& own, asio::ip::address other)
    : acceptor_(io), other_(std::move(other)) {
  error_code ec;
  acceptor_.open(own.protocol(), ec);
  if (!ec) acceptor_.set_option(tcp::acceptor::reuse_address(true), ec);
  if (!ec) acceptor_.bind(own, ec);
  if (!ec) acceptor_.listen(4, ec);
  const tcp::endpoint bound = ec ? tcp::endpoint{} : acceptor_.local_endpoint(ec);
  if (ec) {
    problem_ = ec.message();
    return;
  }
  port_ = bound.port();
  accept();
}

void GreetingListener::accept() {
  acceptor_.async_accept([this](error_code ec, tcp::socket socket) {
    if (ec == asio::error::operation_aborted) return;
    error_code unknown;
    if (!ec && socket.remote_endpoint(unknown).address() == other_ && !unknown) {
      std::make_shared<Accepted>(std::move(socket))->answer();
    }
    accept();
  });
}

Greeter::Greeter(asio::io_context& io, std::function<void(TcpState)> report)
    : socket_(io), timer_(io), report_(std::move(report)) {}

void Greeter::greet(const tcp::endpoint& to) {
  error_code ignored;
  socket_.close(ignored);
  ended_ = false;
  timer_.expires_after(kWithin);
  timer_.async_wait([this](error_code ec) {
    if (!ec) end(TcpState::kNoAnswer);
  });
  socket_.async_connect(to, [this](error_code ec) {
    if (ec == asio::error::operation_aborted) return;
    if (ec) return end(ec == asio::error::connection_refused ? TcpState::kRefused : TcpState::kNoAnswer);
    asio::async_write(socket_, asio::buffer(kGreeting), [](error_code, std::size_t) {});  // the reading notices
    asio::async_read(socket_, asio::buffer(answer_), [this](error_code failed, std::size_t) {
      if (failed == asio::error::operation_aborted) return;
      end(!failed && answer_ == kGreeting ? TcpState::kWorks : TcpState::kNoAnswer);
    });
  });
}

void Greeter::end(TcpState state) {
  if (std::exchange(ended_, true)) return;
  timer_.cancel();
  error_code ignored;
  socket_.close(ignored);
  report_(state);
}

}  // namespace peerd::doctor
