#include "peerd/view/gateway/live_connection.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/pending_lines.hpp"
#include "peerd/peer/control/request.hpp"
#include "peerd/view/gateway/access.hpp"
#include "peerd/view/gateway/limits.hpp"
#include "peerd/view/gateway/live_request.hpp"

namespace peerd::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

// A client that answers no ping for so long is gone. Browsers answer by themselves.
constexpr std::chrono::seconds kSilence{60};
// The kernel keeps so much of what a client has not read: newer poses replace the rest.
constexpr int kSendBuffer_bytes = 131'072;

class LiveConnection : public Connection, public std::enable_shared_from_this<LiveConnection> {
 public:
  LiveConnection(std::shared_ptr<GatewayState> state, asio::ip::tcp::socket socket)
      : state_(std::move(state)),
        stream_(std::move(socket)),
        deadline_(stream_.get_executor()),
        frame_timer_(stream_.get_executor()) {}

  void begin(beast::http::request<beast::http::string_body> upgrade) {
    error_code ignored;
    stream_.next_layer().set_option(asio::ip::tcp::no_delay(true), ignored);
    stream_.next_layer().set_option(asio::socket_base::send_buffer_size(kSendBuffer_bytes), ignored);
    stream_.set_option(websocket::stream_base::timeout{kRequestWithin, kSilence, true});
    stream_.read_message_max(kStrangersBodyMax_bytes);
    stream_.auto_fragment(false);
    upgrade_ = std::move(upgrade);
    stream_.async_accept(upgrade_, [self = shared_from_this()](const error_code& failed) {
      if (self->is_over()) return;
      if (failed) return self->on_failure(failed);
      ++self->state_->counters.live;
      self->upgrade_ = {};
      self->accepted_ = true;
      self->revision_ = self->state_->source.revision();
      self->read();
    });
  }

  void close() override {
    over_ = true;
    error_code ignored;
    stream_.next_layer().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    stream_.next_layer().close(ignored);
    deadline_.cancel();
    frame_timer_.cancel();
  }
  [[nodiscard]] Standing standing() const override { return may_change_ ? Standing::kOwner : Standing::kStranger; }
  // Its client learns of other revisions by edits, too, so it wants these.
  [[nodiscard]] control::EventKinds wanted() const override { return wanted_; }
  void give(control::EventKind kind, const std::string& line) override {
    if (!accepted_ || !wanted_.contains(kind)) return;
    give(line);
  }
  void note_revision(std::uint32_t revision) override {
    if (!accepted_ || revision == revision_) return;
    revision_ = revision;
    give(scene_event(revision));
  }

 private:
  [[nodiscard]] bool is_over() const { return state_->over || over_; }

  void drop() {
    close();
    remove_avatar();
    state_->drop(shared_from_this());
  }

  // Nobody steers it any more.
  void remove_avatar() {
    if (avatar_.empty()) return;
    const nlohmann::json removal = {{"do", "remove"}, {"path", std::exchange(avatar_, {})}};
    (void)state_->source.ask(json_line(removal));
    (void)state_->source.ask(R"({"do":"viewpoint"})");
  }

  void on_failure(const error_code& failed) {
    if (failed == websocket::error::message_too_big) {
      state_->note(RefusalKind::kBodyTooLong);
    } else if (failed == beast::error::timeout) {
      state_->note(RefusalKind::kTooSlow);
    } else if (failed != websocket::error::closed &&
               failed.category() == make_error_code(websocket::error::bad_opcode).category()) {
      state_->note(RefusalKind::kMalformed);
    }
    drop();
  }

  // The next message is read after the reply to the last one has been, so that one reply waits at most.
  void read() {
    stream_.async_read(in_, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (self->is_over()) return;
      if (failed) return self->on_failure(failed);
      ++self->state_->counters.messages;
      self->active_at = Clock::now();
      self->state_->turns->add([self] {
        if (!self->is_over()) self->on_message();
      });
    });
  }

  void on_message() {
    const std::string message = stream_.got_text() ? beast::buffers_to_string(in_.data()) : std::string();
    in_.consume(in_.size());
    if (in_.capacity() > kStrangersBodyMax_bytes) in_.shrink_to_fit();
    std::string reply = reply_to(message);
    if (is_over()) return;
    if (reply.empty()) return read();
    out_.add_reply(std::move(reply));
    write();
  }

  std::string reply_to(const std::string& message) {
    auto request = parse_live_request(message);
    std::string reply;
    if (request.what) {
      reply = std::visit([this](auto& asked) { return answer(asked); }, *request.what);
    } else {
      state_->note(RefusalKind::kMalformed);
      reply = control::refusal(request.what.error());
    }
    return reply.empty() ? reply : with_sequence(std::move(reply), request.sequence);
  }

  std::string answer(const TokenRequest& shown) {
    if (!is_token(shown.token, state_->token)) return refused(RefusalKind::kToken, "this is not the token");
    may_change_ = true;
    stream_.read_message_max(kBodyMax_bytes);
    return control::done_reply();
  }
  std::string answer(const PlainRequest& asked) {
    const auto request = control::parse_request(asked.line);
    if (request && control::changes_something(*request) && !may_change_) {
      return refused(RefusalKind::kToken, std::string(text_of(RefusalKind::kToken).sentence));
    }
    control::Answer answer = state_->source.ask(asked.line);
    if (answer.subscribe) {
      wanted_ = *answer.subscribe;
      state_->find_wanted();
    }
    return std::move(answer.line);
  }

  std::string answer(const WatchRequest& asked) {
    poses_.watch(asked.watch);
    frame_period_ = std::chrono::nanoseconds(std::llround(1e9 / asked.hz));
    watches_ = true;
    next_frame_at_ = std::chrono::steady_clock::now();
    await_frame();
    return control::done_reply();
  }
  std::string answer(const UnwatchRequest& /*asked*/) {
    watches_ = frame_due_ = false;
    frame_timer_.cancel();
    return control::done_reply();
  }
  std::string answer(const PickRequest& asked) { return state_->source.pick(asked.origin, asked.direction); }
  std::string answer(const WalkRequest& asked) { return state_->source.walk(asked.size, asked.stride, asked.except); }
  std::string answer(const AvatarRequest& asked) {
    if (!may_change_) return refused(RefusalKind::kToken, std::string(text_of(RefusalKind::kToken).sentence));
    avatar_ = asked.path;
    return control::done_reply();
  }
  std::string answer(const InspectRequest& asked) {
    return asked.node ? state_->source.inspect(*asked.node) : state_->source.inspect_at(asked.path);
  }

  std::string answer(const SurroundingsRequest& /*asked*/) { return state_->source.surroundings(); }
  std::string answer(const HierarchyRequest& asked) { return state_->source.hierarchy(asked.path, asked.level); }

  // Frames that could not be sent in time are left out.
  void await_frame() {
    frame_timer_.expires_at(next_frame_at_);
    frame_timer_.async_wait([self = shared_from_this()](const error_code& cancelled) {
      if (cancelled || self->is_over()) return;
      self->next_frame_at_ = std::max(self->next_frame_at_ + self->frame_period_, std::chrono::steady_clock::now());
      self->await_frame();
      self->ask_for_frame();
    });
  }

  void ask_for_frame() {
    if (std::exchange(frame_waits_, true)) return;
    state_->turns->add([self = shared_from_this()] {
      self->frame_waits_ = false;
      if (self->is_over()) return;
      if (self->watches_) self->make_frame();
      self->write();
    });
  }

  // While another one, or a line, is on its way, there is none: the next one is newer.
  void make_frame() {
    if (writes_) {
      if (!std::exchange(frame_due_, true)) ++state_->counters.frames_late;
      return;
    }
    frame_due_ = false;
    note_revision(state_->source.revision());
    if (writes_) {
      frame_due_ = true;
      return;
    }
    const auto frame = state_->source.next_frame(poses_);
    ++state_->counters.frames;
    state_->counters.frame_bytes += frame.size();
    stream_.binary(true);
    writes_frame_ = true;
    send(asio::buffer(frame.data(), frame.size()));
  }

  std::string refused(RefusalKind kind, const std::string& sentence) {
    state_->note(kind);
    return control::refusal(sentence);
  }

  void give(const std::string& line) {
    if (out_.add_event(line)) {
      write();
    } else {
      ++state_->counters.events_dropped;
    }
  }

  // One thing is on its way at a time: a line, or a frame of poses.
  void write() {
    if (writes_ || is_over() || out_.empty()) return;
    writing_ = out_.take_front();
    stream_.text(true);
    send(asio::buffer(writing_.text));
  }

  void send(asio::const_buffer bytes) {
    writes_ = true;
    deadline_.expires_after(time_to_read(bytes.size()));
    deadline_.async_wait([self = shared_from_this()](const error_code& cancelled) {
      if (cancelled || self->is_over()) return;
      self->state_->note(RefusalKind::kTooSlow);
      self->drop();
    });
    stream_.async_write(bytes, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (self->is_over()) return;
      self->writes_ = false;
      self->deadline_.cancel();
      if (failed) return self->on_failure(failed);
      self->wrote();
    });
  }

  // Lines and frames take turns where both wait.
  void wrote() {
    const bool was_frame = std::exchange(writes_frame_, false);
    const bool was_reply = std::exchange(writing_, {}).is_reply;
    if (frame_due_ && !was_frame) {
      ask_for_frame();
    } else {
      write();
      if (frame_due_ && !writes_) ask_for_frame();
    }
    if (was_reply && !is_over()) read();
  }

  std::shared_ptr<GatewayState> state_;
  websocket::stream<asio::ip::tcp::socket> stream_;
  asio::steady_timer deadline_;  // of what is being written
  asio::steady_timer frame_timer_;
  beast::http::request<beast::http::string_body> upgrade_;
  beast::flat_buffer in_;
  control::PendingLines out_;
  control::PendingLines::Line writing_;
  control::EventKinds wanted_{};
  std::uint32_t revision_ = 0;  // that the client knows of
  std::string avatar_;          // the path of the client's own; empty: none
  view::PoseStream poses_;
  std::chrono::nanoseconds frame_period_{0};
  std::chrono::steady_clock::time_point next_frame_at_;
  bool watches_ = false;
  bool frame_waits_ = false;   // for its turn
  bool frame_due_ = false;     // as soon as nothing else is on its way
  bool writes_frame_ = false;  // what is on its way is a frame
  bool accepted_ = false;      // it is a WebSocket now
  bool may_change_ = false;    // the client has shown the token
  bool writes_ = false;
  bool over_ = false;
};

}  // namespace

void serve_live(const std::shared_ptr<GatewayState>& state, asio::ip::tcp::socket socket,
                beast::http::request<beast::http::string_body> upgrade) {
  const auto connection = std::make_shared<LiveConnection>(state, std::move(socket));
  state->add(connection);
  connection->begin(std::move(upgrade));
}

}  // namespace peerd::gateway
