#include "peerd/view/gateway/http_connection.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "peerd/peer/control/request.hpp"
#include "peerd/view/gateway/access.hpp"
#include "peerd/view/gateway/http_reply.hpp"
#include "peerd/view/gateway/limits.hpp"
#include "peerd/view/gateway/live_connection.hpp"
#include "peerd/view/gateway/route.hpp"

namespace peerd::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;
using Response = http::response<http::span_body<const char>>;

constexpr int kHttp11 = 11;
constexpr unsigned kNotModified = 304, kCannotBe = 500;
constexpr const char* kPolicy =
    "default-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; img-src 'self' data: blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

// `origin`: of another server's page that is let in; empty: none.
Response response_of(const HttpReply& reply, const std::string& origin, unsigned version, bool keeps_alive) {
  Response response(static_cast<http::status>(reply.status), version);
  response.set(http::field::content_type, beast::string_view(reply.content_type.data(), reply.content_type.size()));
  response.set(http::field::cache_control, reply.immutable ? "public, max-age=31536000, immutable" : "no-cache");
  if (!reply.etag.empty()) response.set(http::field::etag, reply.etag);
  if (reply.gzipped) response.set(http::field::content_encoding, "gzip");
  response.set(http::field::vary, "Accept-Encoding, Origin");
  if (!origin.empty()) response.set(http::field::access_control_allow_origin, origin);
  response.set("Content-Security-Policy", kPolicy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Referrer-Policy", "no-referrer");
  if (reply.status == text_of(RefusalKind::kMethod).status) response.set(http::field::allow, "GET, POST");
  if (reply.status == text_of(RefusalKind::kToken).status) response.set(http::field::www_authenticate, "Bearer");
  response.body() = {reply.body.data(), reply.body.size()};
  response.keep_alive(keeps_alive);
  response.prepare_payload();
  return response;
}

class HttpConnection : public Connection, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(std::shared_ptr<GatewayState> state, asio::ip::tcp::socket socket)
      : state_(std::move(state)), socket_(std::move(socket)), deadline_(socket_.get_executor()) {}

  void close() override {
    error_code ignored;
    socket_.shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
    deadline_.cancel();
  }

  [[nodiscard]] Standing standing() const override {
    if (has_shown_token_) return Standing::kOwner;
    return has_asked_ ? Standing::kStranger : Standing::kSilent;
  }

  // Waits for the first byte of a request.
  void wait() {
    parser_.emplace();
    parser_->header_limit(kHeaderMax_bytes);
    parser_->body_limit(kBodyMax_bytes);
    if (in_.size() > 0) return read_header();
    end_within(kIdle, [this] { drop(); });
    socket_.async_wait(asio::ip::tcp::socket::wait_read, [self = shared_from_this()](const error_code& failed) {
      if (self->is_over()) return;
      if (failed) return self->drop();
      self->read_header();
    });
  }

 private:
  [[nodiscard]] bool is_over() const { return state_->over || !socket_.is_open(); }

  void drop() {
    close();
    state_->drop(shared_from_this());
  }

  template <class Action>
  void end_within(std::chrono::seconds time, Action action) {
    deadline_.expires_after(time);
    deadline_.async_wait([self = shared_from_this(), action](const error_code& cancelled) {
      if (!cancelled && !self->is_over()) action();
    });
  }

  // A request that takes longer is refused; its reading ends by that.
  void read_header() {
    end_within(kRequestWithin, [this] {
      late_ = true;
      error_code ignored;
      socket_.cancel(ignored);
    });
    http::async_read_header(socket_, in_, *parser_, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (self->is_over()) return;
      if (failed) return self->on_failure(failed);
      self->on_header();
    });
  }

  void on_failure(const error_code& failed) {
    if (late_) return refuse(RefusalKind::kTooSlow);
    if (failed == http::error::header_limit) return refuse(RefusalKind::kHeaderTooLong);
    if (failed == http::error::body_limit) return refuse(RefusalKind::kBodyTooLong);
    const bool is_gone = failed == http::error::end_of_stream || failed == http::error::partial_message ||
                         failed.category() != make_error_code(http::error::bad_method).category();
    if (is_gone) return drop();
    refuse(RefusalKind::kMalformed);
  }

  void on_header() {
    ++state_->counters.requests;
    has_asked_ = true;
    active_at = Clock::now();
    const auto& request = parser_->get();
    const bool has_token = is_token(bearer_token(view(request[http::field::authorization])), state_->token);
    has_shown_token_ = has_shown_token_ || has_token;
    const std::string_view host = view(request[http::field::host]);
    if (request.count(http::field::host) != 1 || !is_own_host(host, state_->port)) return refuse(RefusalKind::kHost);
    if (request.count(http::field::origin) > 0 && !let_in(host)) return refuse(RefusalKind::kOrigin);
    auto route = find_route(view(request.method_string()), view(request.target()));
    if (!route) return refuse(route.error());
    if (std::holds_alternative<LiveRoute>(*route)) return become_live();
    if (!std::holds_alternative<RequestRoute>(*route)) {
      if (!parser_->is_done()) return refuse(RefusalKind::kMalformed);  // a body that nobody wants
      return answer(*std::move(route));
    }
    may_change_ = has_token;
    if (!may_change_) {
      if (parser_->content_length().value_or(0) > kStrangersBodyMax_bytes) return refuse(RefusalKind::kBodyTooLong);
      parser_->body_limit(kStrangersBodyMax_bytes);  // of a body in chunks
    }
    read_body();
  }

  // Whether a page of that origin may ask: the gateway's own, or one that the configuration names.
  bool let_in(std::string_view host) {
    const auto& request = parser_->get();
    if (request.count(http::field::origin) > 1) return false;
    const std::string_view origin = view(request[http::field::origin]);
    if (is_own_origin(origin, host)) return true;
    if (std::ranges::find(state_->origins, origin) == state_->origins.end()) return false;
    other_origin_ = origin;
    return true;
  }

  void read_body() {
    http::async_read(socket_, in_, *parser_, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (self->is_over()) return;
      if (failed) return self->on_failure(failed);
      self->answer(RequestRoute{});
    });
  }

  void become_live() {
    deadline_.cancel();
    if (in_.size() > 0 || !beast::websocket::is_upgrade(parser_->get())) return refuse(RefusalKind::kMalformed);
    const auto self = shared_from_this();
    state_->drop(self);
    serve_live(state_, std::move(socket_), parser_->release());
  }

  void answer(Route route) {
    deadline_.cancel();
    state_->turns->add([self = shared_from_this(), asked = std::move(route)] {
      if (self->is_over()) return;
      if (std::holds_alternative<SceneRoute>(asked)) return self->answer_with_scene();
      self->respond(self->reply_to(asked), self->parser_->get().keep_alive());
    });
  }

  HttpReply reply_to(const Route& route) {
    const auto& request = parser_->get();
    const std::string_view known = view(request[http::field::if_none_match]);
    if (const auto* asset = std::get_if<AssetRoute>(&route)) {
      const bool takes_gzip = view(request[http::field::accept_encoding]).find("gzip") != std::string_view::npos;
      HttpReply reply = asset_reply(state_->assets, asset->name, known, takes_gzip);
      if (reply.status == text_of(RefusalKind::kNotFound).status) state_->note(RefusalKind::kNotFound);
      return reply;
    }
    if (const auto* ask = std::get_if<AskRoute>(&route)) return HttpReply::of(state_->source.ask(ask->request).line);
    if (std::holds_alternative<MetricsRoute>(route)) {
      return HttpReply::of(state_->source.metrics(), "text/plain; version=0.0.4; charset=utf-8");
    }
    if (const auto* recording = std::get_if<RecordingRoute>(&route)) return reply_to(*recording, known);
    return reply_to_request(request.body());
  }

  // A file of a recording does not change while this gateway is there.
  HttpReply reply_to(const RecordingRoute& asked, std::string_view known) {
    const auto file = state_->source.recorded_file(asked.name);
    if (!file) return refused(RefusalKind::kNotFound);
    HttpReply reply;
    reply.content_type = file->content_type;
    reply.etag = '"' + state_->start_number + '"';
    if (known == reply.etag) {
      reply.status = kNotModified;
      return reply;
    }
    reply.owner = file->bytes;
    reply.body = *file->bytes;
    return reply;
  }

  void answer_with_scene() {
    state_->source.make_scene([self = shared_from_this()](const SceneFile& scene) {
      if (self->is_over()) return;
      self->respond(self->scene_reply(scene), self->parser_->get().keep_alive());
    });
  }

  HttpReply scene_reply(const SceneFile& scene) {
    if (scene.glb == nullptr) {
      HttpReply reply = HttpReply::of(control::refusal(scene.why_not));
      reply.status = kCannotBe;
      return reply;
    }
    HttpReply reply;
    reply.content_type = "model/gltf-binary";
    reply.etag = '"' + state_->start_number + '-' + std::to_string(scene.revision) + '"';
    if (view(parser_->get()[http::field::if_none_match]) == reply.etag) {
      reply.status = kNotModified;
      return reply;
    }
    reply.owner = scene.glb;
    reply.body = *scene.glb;
    return reply;
  }

  HttpReply reply_to_request(const std::string& body) {
    const auto request = control::parse_request(body);
    if (request && control::changes_something(*request) && !may_change_) return refused(RefusalKind::kToken);
    // There is nobody whom events could be given to.
    if (request && std::holds_alternative<control::SubscribeRequest>(*request)) {
      return HttpReply::of(control::refusal("events come by WebSocket, at /api/v1/live"));
    }
    return HttpReply::of(state_->source.ask(body).line);
  }

  HttpReply refused(RefusalKind kind) {
    state_->note(kind);
    return refusal_reply(kind);
  }

  // Closes the connection afterwards: what follows in the stream may belong to what was refused.
  void refuse(RefusalKind kind) {
    state_->note(kind);
    respond(refusal_reply(kind), false);
  }

  void respond(HttpReply reply, bool keeps_alive) {
    late_ = false;
    const unsigned version = parser_->get().version();
    reply_ = std::move(reply);
    response_.emplace(response_of(reply_, other_origin_, version == 0 ? kHttp11 : version, keeps_alive));
    end_within(time_to_read(reply_.body.size()), [this] {
      state_->note(RefusalKind::kTooSlow);
      drop();
    });
    http::async_write(socket_, *response_, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (self->is_over()) return;
      self->deadline_.cancel();
      if (failed || !self->response_->keep_alive()) return self->finish();
      self->may_change_ = false;
      self->other_origin_.clear();
      self->response_.reset();
      self->reply_ = {};
      self->wait();
    });
  }

  // Lets the client read the reply before the connection goes: a socket that is closed with unread input resets it.
  void finish() {
    error_code ignored;
    socket_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    end_within(std::chrono::seconds(1), [this] { drop(); });
    discard();
  }

  void discard() {
    in_.consume(in_.size());
    constexpr std::size_t kPart_bytes = 16'384;
    socket_.async_read_some(in_.prepare(kPart_bytes),
                            [self = shared_from_this()](const error_code& failed, std::size_t) {
                              if (self->is_over()) return;
                              if (failed) return self->drop();
                              self->discard();
                            });
  }

  std::shared_ptr<GatewayState> state_;
  asio::ip::tcp::socket socket_;
  asio::steady_timer deadline_;
  beast::flat_buffer in_;
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpReply reply_;  // whose body the response refers to
  std::optional<Response> response_;
  std::string other_origin_;  // of the page that asks, where it is another server's and let in
  bool late_ = false;         // the request has taken too long
  bool may_change_ = false;   // the request has the token
  bool has_asked_ = false;    // a request has come, be it answered or not
  bool has_shown_token_ = false;
};

}  // namespace

void serve_http(const std::shared_ptr<GatewayState>& state, asio::ip::tcp::socket socket) {
  const auto connection = std::make_shared<HttpConnection>(state, std::move(socket));
  state->add(connection);
  connection->wait();
}

void refuse_connection(GatewayState& state, asio::ip::tcp::socket socket) {
  state.note(RefusalKind::kTooMany);
  const HttpReply reply = refusal_reply(RefusalKind::kTooMany);
  const std::string text =
      "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nConnection: close\r\n"
      "Content-Length: " +
      std::to_string(reply.body.size()) + "\r\n\r\n" + std::string(reply.body);
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(text), ignored);  // it fits into the buffer of a new socket
  socket.shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
  socket.close(ignored);
}

}  // namespace peerd::gateway
