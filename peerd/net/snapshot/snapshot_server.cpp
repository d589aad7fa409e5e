#include "peerd/net/snapshot/snapshot_server.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/net/os/next_after.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"

namespace peerd::snapshot {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// A joining peer that asks for nothing for so long is gone.
constexpr Duration kPatience = std::chrono::seconds(30);
constexpr std::chrono::seconds kAcceptAgainAfter{1};  // pause after a failure, such as a lack of descriptors

}  // namespace

// The io_context may hold handlers that outlive the server; `over_` tells them.
class SnapshotServer::Impl : public std::enable_shared_from_this<Impl> {
 public:
  Impl(asio::io_context& io, SnapshotContent content, ServesAt serves_at)
      : acceptor_(io), again_(io), turn_(io), content_(std::move(content)), serves_at_(std::move(serves_at)) {}

  std::expected<void, net::NetError> listen(const asio::ip::address& address, std::uint16_t port) {
    error_code failed;
    const asio::ip::tcp::endpoint at(address, port);
    acceptor_.open(at.protocol(), failed);
    net::close_on_exec(acceptor_);
    if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
    if (!failed && at.address().is_v6()) acceptor_.set_option(asio::ip::v6_only(true), failed);
    if (!failed) acceptor_.bind(at, failed);
    if (!failed) acceptor_.listen(kConnectionsMax, failed);
    if (failed) {
      return std::unexpected(
          net::NetError{net::NetError::Kind::kOther, "can't listen for joining peers at " + address.to_string() +
                                                         " port " + std::to_string(port) + ": " + failed.message()});
    }
    accept();
    return {};
  }
  void close() {
    over_ = true;
    error_code ignored;
    acceptor_.close(ignored);
    again_.cancel();
    turn_.cancel();
    waiting_.clear();
    for (const auto& [number, stream] : std::exchange(streams_, {})) stream->close();
  }
  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  using StreamPtr = std::shared_ptr<FramedStream>;

  void accept() {
    acceptor_.async_accept([self = shared_from_this()](const error_code& failed, asio::ip::tcp::socket socket) {
      if (self->over_) return;
      if (failed) return self->accept_later();
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
  void take(asio::ip::tcp::socket socket) {
    net::close_on_exec(socket);
    if (streams_.size() >= kConnectionsMax && !make_room()) return;  // which closes it: it asks elsewhere, or again
    error_code ignored;
    if (serves_at_ && !serves_at_(socket.local_endpoint(ignored).address())) return;  // which closes it
    socket.set_option(asio::ip::tcp::no_delay(true), ignored);
    const auto number = ++taken_;
    const auto stream = std::make_shared<FramedStream>(
        std::move(socket), kRequestMax_bytes, kPatience,
        [self = weak_from_this(), number](const std::string&) {
          if (const auto impl = self.lock()) impl->drop(number);
        },
        seal());
    streams_.emplace(number, stream);
    stream->begin([self = shared_from_this(), number, stream] {
      if (!self->over_) self->serve(number, stream);
    });
  }
  // The connection that has not proven the session's key for the longest time makes room. False: all have, or there is
  // none.
  [[nodiscard]] bool make_room() {
    const auto oldest = std::ranges::find_if(streams_, [](const auto& each) { return each.second->is_unproven(); });
    if (oldest == streams_.end()) return false;
    oldest->second->close();
    streams_.erase(oldest);
    return true;
  }
  [[nodiscard]] std::optional<seal::StreamSeal> seal() const {
    const auto key = content_.key();
    return key ? std::optional(seal::StreamSeal(*key, seal::StreamSeal::End::kServer)) : std::nullopt;
  }
  void serve(std::uint64_t number, const StreamPtr& stream) {
    stream->read([self = shared_from_this(), number, stream](const std::string& request) {
      if (self->over_) return;
      const bool is_first = self->waiting_.empty();
      self->waiting_[stream->remote()].push_back({number, stream, ReplyWork(request, self->content_)});
      if (is_first) self->wait_for_turn();
    });
  }
  // Turns are apart also where nobody waited in between.
  void wait_for_turn() {
    turn_.expires_at(std::max(std::chrono::steady_clock::now(), turn_.expiry() + kStepsApart));
    turn_.async_wait([self = shared_from_this()](const error_code& failed) {
      if (!failed && !self->over_) self->take_turn();
    });
  }
  void take_turn() {
    if (waiting_.empty()) return;
    const auto next = net::next_after(waiting_, served_);
    served_ = next->first;
    Waiting first = std::move(next->second.front());
    next->second.pop_front();
    if (auto reply = first.work.step()) {
      first.stream->write(encode(*reply), [self = shared_from_this(), number = first.number, stream = first.stream] {
        if (!self->over_) self->serve(number, stream);
      });
    } else {
      next->second.push_back(std::move(first));
    }
    if (next->second.empty()) waiting_.erase(next);
    if (!waiting_.empty()) wait_for_turn();
  }
  void drop(std::uint64_t number) {
    streams_.erase(number);
    for (auto& [address, all] : waiting_)
      std::erase_if(all, [&](const Waiting& each) { return each.number == number; });
    std::erase_if(waiting_, [](const auto& each) { return each.second.empty(); });
  }

  struct Waiting {
    std::uint64_t number;  // in streams_
    StreamPtr stream;
    ReplyWork work;
  };

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer again_, turn_;
  SnapshotContent content_;
  ServesAt serves_at_;
  std::map<std::uint64_t, StreamPtr> streams_;  // by the order in which they were taken
  std::uint64_t taken_ = 0;
  std::map<asio::ip::address, std::deque<Waiting>> waiting_;  // for their turns; none is empty
  asio::ip::address served_;                                  // last
  bool over_ = false;
};

SnapshotServer::SnapshotServer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

SnapshotServer::~SnapshotServer() { impl_->close(); }

std::uint16_t SnapshotServer::port() const { return impl_->port(); }

std::expected<std::unique_ptr<SnapshotServer>, net::NetError> SnapshotServer::open(asio::io_context& io,
                                                                                   const asio::ip::address& address,
                                                                                   std::uint16_t port,
                                                                                   SnapshotContent content,
                                                                                   ServesAt serves_at) {
  auto impl = std::make_shared<Impl>(io, std::move(content), std::move(serves_at));
  if (auto listening = impl->listen(address, port); !listening) return std::unexpected(listening.error());
  return std::unique_ptr<SnapshotServer>(new SnapshotServer(std::move(impl)));
}

}  // namespace peerd::snapshot
