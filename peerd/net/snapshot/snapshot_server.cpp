#include "peerd/net/snapshot/snapshot_server.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::snapshot {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using replication::LogLength;
using replication::OperationRange;

// A joining peer that asks for nothing for so long is gone.
constexpr Duration kPatience = std::chrono::seconds(30);
constexpr std::chrono::seconds kAcceptAgainAfter{1};  // pause after a failure, such as a lack of descriptors

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<LogLength> whole_logs(const replication::OperationLogs& logs, SimTime latest) {
  std::vector<LogLength> whole;
  for (const LogLength& log : logs.lengths()) {
    if (const std::uint64_t bytes = logs.whole(log.author); bytes > 0 && logs.last_stamp(log.author) <= latest)
      whole.push_back({log.author, bytes});
  }
  return whole;
}

Reply part_of(const OperationRange& range, const SnapshotContent& content) {
  std::string_view bytes;
  std::vector<std::byte> of_log;
  if (range.author != replication::kNoAuthor) {
    of_log = content.logs().bytes(range);
    bytes = as_text(of_log);
  } else if (range.from < content.archive.size()) {
    bytes = content.archive.substr(range.from, range.to - range.from);
  }
  if (bytes.size() != range.to - range.from) return Refusal{"this peer does not hold that"};
  return Part{std::string(bytes)};
}

Digests digests_of(const DigestRequest& asked, const replication::OperationLogs& logs) {
  Digests all;
  for (const LogLength& log : asked.logs) {
    const auto bytes = logs.bytes({log.author, 0, log.bytes});
    all.digests.push_back(bytes.size() == log.bytes ? digest(as_text(bytes)) : 0);
  }
  return all;
}

}  // namespace

Reply reply_to(std::string_view bytes, const SnapshotContent& content) {
  const auto request = decode_request(bytes);
  if (!request) return Refusal{request.error()};
  if (request->session != 0 && request->session != content.session) return Refusal{"this peer is in another world"};
  if (const auto* part = std::get_if<PartRequest>(&request->what)) return part_of(part->range, content);
  if (const auto* asked = std::get_if<DigestRequest>(&request->what)) return digests_of(*asked, content.logs());
  return Offer{.protocol = replication::kProtocolVersion,
               .session = content.session,
               .world = content.world,
               .settings = content.settings,
               .genesis = content.genesis,
               .archive_bytes = content.archive.size(),
               .archive_digest = content.archive_digest,
               .logs = whole_logs(content.logs(), content.latest_stamp()),
               .line = content.line()};
}

// The io_context may hold handlers that outlive the server; `over_` tells them.
class SnapshotServer::Impl : public std::enable_shared_from_this<Impl> {
 public:
  Impl(asio::io_context& io, SnapshotContent content, ServesAt serves_at)
      : acceptor_(io), again_(io), content_(std::move(content)), serves_at_(std::move(serves_at)) {}

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
    stream->begin([self = shared_from_this(), stream] {
      if (!self->over_) self->serve(stream);
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
  void serve(const StreamPtr& stream) {
    stream->read([self = shared_from_this(), stream](const std::string& request) {
      if (self->over_) return;
      stream->write(encode(reply_to(request, self->content_)), [self, stream] {
        if (!self->over_) self->serve(stream);
      });
    });
  }
  void drop(std::uint64_t number) { streams_.erase(number); }

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer again_;
  SnapshotContent content_;
  ServesAt serves_at_;
  std::map<std::uint64_t, StreamPtr> streams_;  // by the order in which they were taken
  std::uint64_t taken_ = 0;
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
