#include "peerd/view/gateway/gateway.hpp"

#include <sys/resource.h>

#include <chrono>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "peerd/net/os/close_on_exec.hpp"
#include "peerd/view/gateway/gateway_state.hpp"
#include "peerd/view/gateway/http_connection.hpp"
#include "peerd/view/gateway/limits.hpp"

namespace peerd::gateway {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kAcceptAgainAfter{1};  // pause after a failure, such as a lack of descriptors
// Descriptors that the rest of the peer may need.
constexpr rlim_t kOtherDescriptors = 256;

// A process may have 1,024 descriptors by default, though more are allowed: that many connections would leave none for
// the store or a capture.
void allow_descriptors() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(limit.rlim_max, kConnectionsMax + kOtherDescriptors);
  if (limit.rlim_cur >= wanted) return;
  limit.rlim_cur = wanted;
  (void)setrlimit(RLIMIT_NOFILE, &limit);  // where it can't be, connections_max() is lower
}

std::size_t connections_max() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return kConnectionsMax;
  const rlim_t left = limit.rlim_cur > kOtherDescriptors ? limit.rlim_cur - kOtherDescriptors : limit.rlim_cur / 2;
  return std::min<std::size_t>(kConnectionsMax, left);
}

std::string text_of(const tcp::endpoint& at) {
  const std::string address = at.address().to_string();
  return (at.address().is_v6() ? '[' + address + ']' : address) + ':' + std::to_string(at.port());
}

}  // namespace

std::optional<RecordedFile> GatewaySource::recorded_file(std::string_view name) {
  if (!name.empty()) return std::nullopt;
  return RecordedFile{std::make_shared<const std::string>(R"({"v":1,"ok":true,"recording":null})"), "application/json"};
}

class Gateway::Impl : public std::enable_shared_from_this<Impl> {
 public:
  Impl(asio::io_context& io, GatewaySource& source, Options options)
      : acceptor_(io),
        again_(io),
        state_(std::make_shared<GatewayState>(io, source, options.assets, std::move(options.token),
                                              std::move(options.origins), std::move(options.log))) {}

  Result<void> listen(const tcp::endpoint& at) {
    allow_descriptors();
    connections_max_ = connections_max();
    error_code failed;
    acceptor_.open(at.protocol(), failed);
    net::close_on_exec(acceptor_);
    if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
    if (!failed) acceptor_.bind(at, failed);
    if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
    if (failed) {
      return std::unexpected(
          InputError{"error: the viewer can't be served at " + text_of(at) + ": " + failed.message(), kSystemFailed});
    }
    state_->port = acceptor_.local_endpoint().port();
    accept();
    return {};
  }

  void close() {
    state_->over = true;
    error_code ignored;
    acceptor_.close(ignored);
    again_.cancel();
    state_->turns->clear();
    for (const auto& connection : std::exchange(state_->connections, {})) connection->close();
  }

  void publish(control::EventKind kind, const std::string& line) {
    const bool edits = kind == control::EventKind::kEdits && !state_->connections.empty();
    const std::uint32_t revision = edits ? state_->source.revision() : 0;
    for (const auto& connection : std::vector(state_->connections.begin(), state_->connections.end())) {
      connection->give(kind, line);
      if (edits) connection->note_revision(revision);
    }
  }

  [[nodiscard]] const GatewayState& state() const { return *state_; }
  [[nodiscard]] tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }

 private:
  void accept() {
    acceptor_.async_accept([self = shared_from_this()](const error_code& failed, tcp::socket socket) {
      if (self->state_->over) return;
      if (failed) return self->accept_later();
      self->take(std::move(socket));
      self->accept();
    });
  }
  void accept_later() {
    again_.expires_after(kAcceptAgainAfter);
    again_.async_wait([self = shared_from_this()](const error_code&) {
      if (!self->state_->over) self->accept();
    });
  }
  void take(tcp::socket socket) {
    net::close_on_exec(socket);
    ++state_->counters.connections;
    if (state_->connections.size() >= connections_max_ && !state_->make_room(Connection::Clock::now())) {
      return refuse_connection(*state_, std::move(socket));
    }
    serve_http(state_, std::move(socket));
  }

  tcp::acceptor acceptor_;
  asio::steady_timer again_;
  std::shared_ptr<GatewayState> state_;
  std::size_t connections_max_ = kConnectionsMax;
};

Gateway::Gateway(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

Gateway::~Gateway() { impl_->close(); }

tcp::endpoint Gateway::endpoint() const { return impl_->endpoint(); }

std::string Gateway::url() const {
  const std::string& token = impl_->state().token;
  return "http://" + text_of(endpoint()) + '/' + (token.empty() ? "" : "#token=" + token);
}

control::EventKinds Gateway::wanted() const {
  control::EventKinds kinds = impl_->state().wanted();
  if (!impl_->state().connections.empty()) kinds.add(control::EventKind::kEdits);  // which make other revisions
  return kinds;
}

void Gateway::publish(control::EventKind kind, const std::string& line) { impl_->publish(kind, line); }

const GatewayCounters& Gateway::counters() const { return impl_->state().counters; }

std::size_t Gateway::connections() const { return impl_->state().connections.size(); }

Result<std::unique_ptr<Gateway>> Gateway::open(asio::io_context& io, GatewaySource& source, Options options) {
  const tcp::endpoint at = options.at;
  auto impl = std::make_shared<Impl>(io, source, std::move(options));
  if (auto listening = impl->listen(at); !listening) return std::unexpected(listening.error());
  return std::unique_ptr<Gateway>(new Gateway(std::move(impl)));
}

}  // namespace peerd::gateway
