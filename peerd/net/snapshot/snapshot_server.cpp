#include "peerd/net/snapshot/snapshot_server.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/net/os/next_after.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"
#include "peerd/net/snapshot/places.hpp"

namespace peerd::snapshot {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

// A joining peer that asks for nothing for so long is gone.
constexpr Duration kPatience = std::chrono::seconds(30);
// A connection that has proven the key by its hello alone, which somebody may have recorded at another peer, has to
// send its first sealed frame within this time.
constexpr Duration kSealedWithin = std::chrono::seconds(3);
constexpr std::chrono::seconds kAcceptAgainAfter{1};  // pause after a failure, such as a lack of descriptors
// The last hellos that were proven, so that somebody who has recorded one proves nothing by it.
constexpr std::size_t kHellosKept = 4096;

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
    if (!failed) acceptor_.listen(kProvenMax + kUnprovenMax, failed);
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
    for (auto& waiting : waiting_) waiting.clear();
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
    error_code ignored;
    if (serves_at_ && !serves_at_(socket.local_endpoint(ignored).address())) return;  // which closes it
    socket.set_option(asio::ip::tcp::no_delay(true), ignored);
    const auto number = ++taken_;
    const auto from = socket.remote_endpoint(ignored).address();
    const auto stream = std::make_shared<FramedStream>(
        std::move(socket), kRequestMax_bytes, kPatience,
        [self = weak_from_this(), number](const std::string&) {
          if (const auto impl = self.lock()) impl->drop(number);
        },
        std::nullopt);
    streams_.emplace(number, stream);
    if (const auto closed = places_.add(number, from)) evict(*closed);
    if (!content_.key()) return serve(number, stream);
    stream->read_hello([self = shared_from_this(), number, stream](const std::string& hello) {
      if (!self->over_) self->take_hello(number, stream, hello);
    });
  }
  // Whoever has the key proves it by the hello and is served first. The exchange of keys waits for its turn as all work
  // does.
  void take_hello(std::uint64_t number, const StreamPtr& stream, const std::string& hello) {
    const auto key = content_.key();
    if (!key) return stream->refuse(FramedStream::Refused::kOtherKey, hello);  // the session was sealed before
    const bool is_proven = seal::StreamSeal::is_proven(*key, hello);
    if (!is_proven && seal::StreamSeal::has_proof(hello)) {
      return stream->refuse(FramedStream::Refused::kOtherKey, hello);
    }
    if (is_proven) stream->set_patience(kSealedWithin);
    if (is_proven && is_new(hello) && !keeps_place(number)) {
      return stream->refuse(FramedStream::Refused::kNoPlace, hello);
    }
    await_turn({number, stream, hello});
  }
  // A connection has proven itself, and another one may have to go for it. False: it has to go itself.
  [[nodiscard]] bool keeps_place(std::uint64_t number) {
    const auto closed = places_.note_proven(number);
    if (closed == number) return false;
    if (closed) evict(*closed);
    return true;
  }
  void evict(std::uint64_t number) {
    streams_.at(number)->close();
    drop(number);
  }
  [[nodiscard]] bool is_new(const std::string& hello) {
    if (!hellos_.insert(hello).second) return false;
    hellos_in_order_.push_back(hello);
    if (hellos_in_order_.size() > kHellosKept) {
      hellos_.erase(hellos_in_order_.front());
      hellos_in_order_.pop_front();
    }
    return true;
  }
  void serve(std::uint64_t number, const StreamPtr& stream) {
    stream->read([self = shared_from_this(), number, stream](const std::string& request) {
      if (self->over_) return;
      // The session's key has opened the request, or the session is open.
      if (!self->keeps_place(number)) return self->evict(number);
      stream->set_patience(kPatience);
      self->await_turn({number, stream, ReplyWork(request, self->content_)});
    });
  }
  struct Waiting;
  // Connections that have proven the key are served before all others.
  void await_turn(Waiting waiting) {
    const bool is_first = waiting_[0].empty() && waiting_[1].empty();
    waiting_[places_.is_proven(waiting.number) ? 0 : 1][waiting.stream->remote()].push_back(std::move(waiting));
    if (is_first) wait_for_turn();
  }
  // Turns are apart also where nobody waited in between.
  void wait_for_turn() {
    turn_.expires_at(std::max(std::chrono::steady_clock::now(), turn_.expiry() + kStepsApart));
    turn_.async_wait([self = shared_from_this()](const error_code& failed) {
      if (!failed && !self->over_) self->take_turn();
    });
  }
  void take_turn() {
    const std::size_t kind = waiting_[0].empty() ? 1 : 0;
    auto& waiting = waiting_.at(kind);
    if (waiting.empty()) return;
    const auto next = net::next_after(waiting, served_.at(kind));
    served_.at(kind) = next->first;
    Waiting first = std::move(next->second.front());
    next->second.pop_front();
    if (!step(first)) next->second.push_back(std::move(first));
    if (next->second.empty()) waiting.erase(next);
    if (!waiting_[0].empty() || !waiting_[1].empty()) wait_for_turn();
  }
  // Whether that was the last step of the work.
  bool step(Waiting& waiting) {
    const auto then_serve = [self = shared_from_this(), number = waiting.number, stream = waiting.stream] {
      if (!self->over_) self->serve(number, stream);
    };
    if (const auto* hello = std::get_if<std::string>(&waiting.work)) {
      if (const auto key = content_.key()) {
        waiting.stream->answer_hello({*key, seal::StreamSeal::End::kServer}, *hello, then_serve);
      } else {
        waiting.stream->refuse(FramedStream::Refused::kOtherKey, *hello);
      }
      return true;
    }
    const auto reply = std::get<ReplyWork>(waiting.work).step();
    if (reply) waiting.stream->write(encode(*reply), then_serve);
    return reply.has_value();
  }
  void drop(std::uint64_t number) {
    streams_.erase(number);
    places_.remove(number);
    for (auto& waiting : waiting_) {
      for (auto& [address, all] : waiting)
        std::erase_if(all, [&](const Waiting& each) { return each.number == number; });
      std::erase_if(waiting, [](const auto& each) { return each.second.empty(); });
    }
  }

  struct Waiting {
    std::uint64_t number;  // in streams_
    StreamPtr stream;
    std::variant<std::string, ReplyWork> work;  // a hello, to be answered; a request
  };

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer again_, turn_;
  SnapshotContent content_;
  ServesAt serves_at_;
  std::map<std::uint64_t, StreamPtr> streams_;  // by the order in which they were taken
  std::uint64_t taken_ = 0;
  Places places_{kProvenMax, kUnprovenMax};
  std::set<std::string> hellos_;
  std::deque<std::string> hellos_in_order_;
  // The hellos and requests that wait for their turn, by address; no queue is empty. The first map holds those of
  // connections that have proven the key.
  std::array<std::map<asio::ip::address, std::deque<Waiting>>, 2> waiting_;
  std::array<asio::ip::address, 2> served_;  // last, of each map
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
