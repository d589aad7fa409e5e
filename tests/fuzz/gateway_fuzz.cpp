// Sends any bytes to a gateway over loopback, as HTTP, as frames of a WebSocket, or as its messages. Whatever they are,
// nothing of the peer changes, for they don't know the token, no connection stays, and the next request is answered.
//
// The first byte of an input says what the others are: 'h' a stream of HTTP, 'f' frames, 'm' messages, one a line.
// @HOST@ in them stands for the gateway's address.
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <nlohmann/json.hpp>

#include "core/scene/reader.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/feed/json_members.hpp"
#include "peerd/view/gateway/gateway.hpp"
#include "peerd/view/gateway/metrics.hpp"
#include "peerd/view/picks/hierarchy_level.hpp"
#include "peerd/view/picks/inspect.hpp"
#include "peerd/view/picks/surroundings.hpp"
#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/live_picture.hpp"
#include "peerd/view/picture/scene_picture.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace peerd;
namespace asio = boost::asio;
using fuzz::require;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF B Transform { translation 5 0 0 children Shape { geometry Box { } } }
DEF ADD KeySensor { recipient "A" keyValue 65 value 1 0 0 }
)";
constexpr const char* kUpgrade =
    "GET /api/v1/live HTTP/1.1\r\nHost: @HOST@\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
constexpr int kMessagesMax = 64;  // in one input
constexpr int kQuietTurns = 3;    // of the loop, without anything to do

// A peer in fake time, as a gateway asks it.
class Source : public gateway::GatewaySource {
 public:
  Source() : picture_("fuzzed", {}) {
    world_.world.scene = read_world(kWorld).scene.value();
    world_.model = replication::make_world_model(world_.world.scene);
    config::PeerSettings settings;
    settings.name = "fuzzed";
    settings.id = 1;
    config::PeerObjects objects;
    objects.owned = {*world_.world.scene.find("A")};
    node_ = PeerNode::make(settings, {}, world_, std::move(objects), {});
    while (!node_->start() || node_->peer().clock().to_session(now_) < *node_->start()) pass();
  }
  void pass() {
    now_ += std::chrono::milliseconds(5);
    node_->on_tick(now_);
    while (node_->poll_output()) {
    }
  }

  control::Answer ask(std::string_view request) override {
    pass();
    return control::answer(*node_, now_, request);
  }
  std::string metrics() override {
    const auto reply = [&](const char* request) { return nlohmann::json::parse(ask(request).line); };
    return gateway::metrics_text(reply(R"({"do":"status"})"), reply(R"({"do":"peers"})"));
  }
  std::uint32_t revision() override {
    picture_.follow(*node_);
    return picture_.revision();
  }
  void make_scene(std::function<void(const gateway::SceneFile&)> done) override {
    const std::uint32_t current = revision();
    const auto glb = view::write_glb(view::picture_of(picture_.input(*node_, now_)));
    done({current, std::make_shared<const std::string>(glb.value()), {}});
  }
  std::span<const std::byte> next_frame(view::PoseStream& client) override {
    (void)revision();
    picture_.refresh(*node_, now_, client.watched().kinds);
    picture_.refresh_looks(now_);
    return client.next(picture_.poses(), &picture_.looks());
  }
  std::string pick(const Vec3& origin, const Vec3& direction) override {
    (void)revision();
    return picture_.pick(*node_, now_, origin, direction).dump();
  }
  std::string walk(const view::AvatarSize& size, const view::Stride& stride, const std::string& except) override {
    (void)revision();
    return picture_.walk(*node_, now_, size, stride, except).dump();
  }
  std::string inspect(std::uint32_t node) override {
    (void)revision();
    return picture_.inspect(*node_, node).dump();
  }
  std::string inspect_at(const std::string& path) override { return view::inspect(*node_, path).dump(); }
  std::string surroundings() override {
    (void)revision();
    const auto at = picture_.advance(*node_, now_);
    return at ? view::surroundings(*node_, *at, picture_.movers().ids).dump() : R"({"ok":false})";
  }
  std::string hierarchy(const std::string& path, std::uint32_t level) override {
    const auto id = node_->scene().find(path);
    if (!id) return R"({"ok":false})";
    const auto found = view::hierarchy_level(node_->scene(), *id, level);
    return found ? view::to_json(*found).dump() : R"({"ok":false})";
  }

  [[nodiscard]] bool is_as_it_was() {
    const auto& counters = node_->log().counters;
    const bool posed = counters.contains("poses_taken") || counters.contains("keys");
    return counters.at("operations") == 0 && !posed && revision() == 1;
  }

 private:
  SharedWorld world_;
  std::unique_ptr<PeerNode> node_;
  view::LivePicture picture_;
  HostTime now_{std::chrono::seconds(1'000)};
};

class Driver {
 public:
  Driver()
      : gateway_(std::move(gateway::Gateway::open(io_, source_,
                                                  {.at = {asio::ip::address_v4::loopback(), 0},
                                                   .assets = {},
                                                   .token = "0123456789abcdefghijkl",
                                                   .log = [](const LogLine&) {}})
                               .value())) {}

  void run(char kind, std::string bytes) {
    asio::ip::tcp::socket client = connect();
    if (kind == 'h') {
      (void)talk(client, with_host(std::move(bytes)));
    } else {
      require(talk(client, with_host(kUpgrade)).starts_with("HTTP/1.1 101 "));
      if (kind == 'f') (void)talk(client, bytes);
      if (kind == 'm') send_messages(client, bytes);
    }
    close(client);
    require(gateway_->connections() == 0);
    require(source_.is_as_it_was());
    asio::ip::tcp::socket next = connect();
    require(talk(next, with_host("GET /api/v1/status HTTP/1.1\r\nHost: @HOST@\r\n\r\n")).starts_with("HTTP/1.1 200 "));
    close(next);
  }

 private:
  asio::ip::tcp::socket connect() {
    asio::ip::tcp::socket client(io_);
    client.connect(gateway_->endpoint());
    client.set_option(asio::socket_base::linger(true, 0));  // no port waits for late segments
    client.non_blocking(true);
    return client;
  }
  // Sends the bytes, and returns what comes until the loop has nothing to do.
  std::string talk(asio::ip::tcp::socket& client, std::string_view bytes) {
    std::string reply;
    for (int quiet = 0; quiet < kQuietTurns;) {
      boost::system::error_code failed;
      const std::size_t sent = bytes.empty() ? 0 : client.write_some(asio::buffer(bytes), failed);
      bytes.remove_prefix(sent);
      if (failed && failed != asio::error::would_block) bytes = {};
      const std::size_t done = io_.poll();
      char part[4096];
      const std::size_t received = client.read_some(asio::buffer(part), failed);
      reply.append(part, received);
      quiet = sent + done + received > 0 ? 0 : quiet + 1;
      if (reply.size() > (std::size_t{1} << 20)) break;  // frames come as long as they are wanted
    }
    return reply;
  }
  void send_messages(asio::ip::tcp::socket& client, std::string_view bytes) {
    fuzz::for_each_line(bytes, kMessagesMax, [&](std::string_view line) {
      const std::string_view message = line.substr(0, 0xFFFF);
      std::string frame{'\x81', '\xFE', static_cast<char>(message.size() >> 8), static_cast<char>(message.size()), 0, 0,
                        0,      0};
      if (message.size() < 126) frame = {'\x81', static_cast<char>(0x80 | message.size()), 0, 0, 0, 0};
      (void)talk(client, frame + std::string(message));
    });
  }
  void close(asio::ip::tcp::socket& client) {
    boost::system::error_code ignored;
    client.close(ignored);
    for (int turns = 0; turns < 1000 && gateway_->connections() > 0; ++turns) {
      io_.run_one_for(std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] std::string with_host(std::string text) const {
    constexpr std::string_view kPlace = "@HOST@";
    const std::string host = "127.0.0.1:" + std::to_string(gateway_->endpoint().port());
    for (std::size_t at = 0; (at = text.find(kPlace, at)) != std::string::npos; at += host.size()) {
      text.replace(at, kPlace.size(), host);
    }
    return text;
  }

  asio::io_context io_{1};
  Source source_;
  std::unique_ptr<gateway::Gateway> gateway_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Driver driver;  // no input changes it, as each one checks
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.empty() || (bytes[0] != 'h' && bytes[0] != 'f' && bytes[0] != 'm')) return 0;
  driver.run(bytes[0], std::string(bytes.substr(1)));
  return 0;
}
