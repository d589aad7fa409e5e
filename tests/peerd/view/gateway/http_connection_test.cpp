// A real peer under clients that are many, slow, broken or hostile.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <boost/asio/ip/tcp.hpp>
#include <deque>
#include <fstream>
#include <optional>
#include <random>
#include <thread>

#include "peerd/view/frames/pose_frame.hpp"
#include "peerd/view/gateway/gateway_state.hpp"
#include "peerd/view/gateway/limits.hpp"
#include "tests/peerd/view/gateway/served_peer.hpp"
#include "tests/peerd/view/gateway/web_client.hpp"

namespace peerd::gateway::http_connection_test {

using testing_support::LiveClient;
using testing_support::ServedPeer;
using testing_support::WebClient;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { velocityVector 1 0 0 children Shape { geometry Box { } } }
)";

// Many boxes, each of which moves.
std::string crowd(int count) {
  std::string world = "#VRML V2.0 utf8\n";
  for (int i = 0; i < count; ++i) {
    world += "DEF B" + std::to_string(i) + " Transform { translation 0 " + std::to_string(3 * i) +
             " 0 velocityVector 1 0 0 children Shape { geometry Box { } } }\n";
  }
  return world;
}
std::vector<std::string> names(int count) {
  std::vector<std::string> all;
  for (int i = 0; i < count; ++i) all.push_back("B" + std::to_string(i));
  return all;
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

class GatewayAbuse : public testing::Test {
 protected:
  GatewayAbuse() {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  // Both the requests and the ticks go on.
  void expect_alive(ServedPeer& peer) {
    WebClient client(peer);
    EXPECT_EQ(client.get("/api/v1/status").result_int(), 200U);
    const std::uint64_t ticks = peer.counter("ticks");
    EXPECT_TRUE(ServedPeer::soon([&] { return peer.counter("ticks") > ticks + 3; }));
    EXPECT_EQ(peer.counter("operations"), 0U);
    EXPECT_EQ(peer.counter("keys"), 0U);
  }
};

TEST_F(GatewayAbuse, AThousandConnectionsAreServedAndNoMore) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < 2 * kConnectionsMax + 300) GTEST_SKIP() << "no more than " << limit.rlim_cur << " descriptors";
  ServedPeer peer(kWorld, {"CAR"});
  const std::size_t before = resident_bytes();
  std::deque<WebClient> clients;
  for (std::size_t i = 0; i < kConnectionsMax; ++i) {
    clients.emplace_back(peer);
    if (i % 100 < 99) continue;
    EXPECT_TRUE(ServedPeer::soon([&] { return peer.connections() == i + 1; }));
  }
  std::optional<WebClient> surplus(std::in_place, peer);
  EXPECT_EQ(surplus->get("/api/v1/status").result_int(), 200U);
  EXPECT_EQ(peer.counter("gateway.refused_too_many"), 1U);
  EXPECT_EQ(peer.connections(), kConnectionsMax);
  EXPECT_EQ(clients.front().receive_all(), "") << "the oldest one that has asked for nothing made room";
  clients.pop_front();
  for (WebClient& client : clients) EXPECT_EQ(client.get("/api/v1/status").result_int(), 200U);
  const std::size_t grown = resident_bytes() - std::min(before, resident_bytes());
  RecordProperty("grown_bytes", static_cast<int>(grown));
  EXPECT_LT(grown, std::size_t{128} << 20) << "both ends of a thousand connections are here";
  clients.clear();
  surplus.reset();
  EXPECT_TRUE(ServedPeer::soon([&] { return peer.connections() == 0; }));
  expect_alive(peer);
}

// A page keeps its connection and asks for nothing at present.
TEST_F(GatewayAbuse, APageThatHasAskedStaysWhereOthersAreSilent) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < 2 * kConnectionsMax + 300) GTEST_SKIP() << "no more than " << limit.rlim_cur << " descriptors";
  ServedPeer peer(kWorld, {"CAR"});
  WebClient page(peer);
  EXPECT_EQ(page.get("/api/v1/status").result_int(), 200U);
  std::deque<WebClient> silent;
  for (std::size_t i = 1; i < kConnectionsMax; ++i) silent.emplace_back(peer);
  EXPECT_TRUE(ServedPeer::soon([&] { return peer.connections() == kConnectionsMax; }));
  std::this_thread::sleep_for(kAsksWithin + std::chrono::milliseconds(100));
  EXPECT_EQ(WebClient(peer).get("/api/v1/status").result_int(), 200U);
  EXPECT_EQ(silent.front().receive_all(), "") << "the oldest one that is silent made room";
  EXPECT_EQ(page.get("/api/v1/status").result_int(), 200U);
}

TEST_F(GatewayAbuse, WhoHasShownTheTokenMakesNoRoom) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < 2 * kConnectionsMax + 300) GTEST_SKIP() << "no more than " << limit.rlim_cur << " descriptors";
  ServedPeer peer(kWorld, {"CAR"});
  std::deque<WebClient> clients;
  for (std::size_t i = 0; i < kConnectionsMax; ++i) {
    EXPECT_EQ(clients.emplace_back(peer).post({{"do", "status"}}, ServedPeer::kToken).result_int(), 200U);
  }
  EXPECT_EQ(WebClient(peer).receive().result_int(), 503U);
  for (WebClient& client : clients) EXPECT_EQ(client.get("/api/v1/status").result_int(), 200U);
}

// Strangers watch by WebSockets, and one owner.
TEST_F(GatewayAbuse, TheOwnersPageStaysWhereStrangersWatch) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < 2 * kConnectionsMax + 300) GTEST_SKIP() << "no more than " << limit.rlim_cur << " descriptors";
  ServedPeer peer(kWorld, {"CAR"});
  LiveClient owner(peer, true);
  std::deque<LiveClient> strangers;
  for (std::size_t i = 1; i < kConnectionsMax; ++i) strangers.emplace_back(peer, false);
  EXPECT_EQ(WebClient(peer).get("/api/v1/status").result_int(), 200U);
  EXPECT_EQ(owner.ask({{"do", "status"}})["ok"], true);
}

TEST_F(GatewayAbuse, MalformedRequestsAreRefused) {
  ServedPeer peer(kWorld, {"CAR"});
  const std::string host = "Host: " + peer.host() + "\r\n";
  const std::vector<std::string> requests{
      "\r\n\r\n\r\n",
      "GET\r\n\r\n",
      "GET / HTTP/9.9\r\n" + host + "\r\n",
      "GET / HTTP/1.1\r\nHost\r\n\r\n",
      "GET / HTTP/1.1\r\n" + host + "Content-Length: -1\r\n\r\n",
      "GET / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello",
      "GET / HTTP/1.1\r\n" + host + "Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello!",
      "POST /api/v1/request HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\nzz\r\n",
      "POST /api/v1/request HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n",
      "POST /api/v1/request HTTP/1.1\r\n" + host + "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
      "GET /\x01 HTTP/1.1\r\n" + host + "\r\n",
      "GET / HTTP/1.1\r\n" + host + "X: \x7f\r\n\r\n",
      "G\xffT / HTTP/1.1\r\n" + host + "\r\n",
      std::string("GET / HTTP/1.1\r\n") + host + std::string("X: a\0b\r\n\r\n", 10),
      "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
      std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11)};
  for (const std::string& request : requests) {
    WebClient client(peer);
    client.send(request);
    boost::system::error_code ignored;
    client.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    const auto reply = client.receive_all();
    ASSERT_TRUE(reply) << "the connection is still open after " << request;
    const std::string status = reply->substr(0, 12);
    EXPECT_TRUE(reply->empty() || status.starts_with("HTTP/1.1 4") || status.starts_with("HTTP/1.0 4")) << *reply;
  }
  EXPECT_GT(peer.counter("gateway.refused_malformed"), 5U);
  expect_alive(peer);
}

// Random bytes, and requests with random damage, by one seed.
TEST_F(GatewayAbuse, DamagedRequestsChangeNothing) {
  ServedPeer peer(kWorld, {"CAR"});
  std::mt19937 random(36);
  const std::string good = "POST /api/v1/request HTTP/1.1\r\nHost: " + peer.host() +
                           "\r\nAuthorization: Bearer 0123456789abcdefghijk\r\nContent-Length: 24\r\n\r\n" +
                           R"({"do":"key","value":65 })";
  for (int tries = 0; tries < 300; ++tries) {
    std::string request = good;
    for (int damages = 0; damages < 1 + tries % 5; ++damages) {
      const std::size_t at = random() % request.size();
      if (random() % 3 == 0)
        request.erase(at, random() % 10);
      else
        request[at] = static_cast<char>(random());
    }
    WebClient client(peer);
    client.send(request);
    boost::system::error_code ignored;
    client.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    ASSERT_TRUE(client.receive_all()) << tries;
  }
  expect_alive(peer);
}

TEST_F(GatewayAbuse, HalfRequestsEndInTime) {
  ServedPeer peer(kWorld, {"CAR"});
  std::deque<WebClient> clients;
  for (const std::string& half :
       {std::string("G"), std::string("GET / HTTP/1.1\r\nHost: "),
        "POST /api/v1/request HTTP/1.1\r\nHost: " + peer.host() + "\r\nContent-Length: 100\r\n\r\n{\"do\""}) {
    for (int i = 0; i < 10; ++i) {
      clients.emplace_back(peer);
      clients.back().send(half);
    }
  }
  for (WebClient& client : clients) EXPECT_EQ(client.receive().result_int(), 408U);
  clients.clear();
  EXPECT_TRUE(ServedPeer::soon([&] { return peer.connections() == 0; }));
  EXPECT_EQ(peer.counter("gateway.refused_too_slow"), 30U);
  expect_alive(peer);
}

TEST_F(GatewayAbuse, MalformedFramesEndTheConnection) {
  ServedPeer peer(kWorld, {"CAR"});
  const auto masked = [](std::uint8_t first, std::uint8_t length, const std::string& payload) {
    return std::string{static_cast<char>(first), static_cast<char>(0x80 | length), 0, 0, 0, 0} + payload;
  };
  const std::vector<std::string> frames{
      std::string("\x81\x02{}", 4),                                         // without a mask
      masked(0x83, 1, "x"),                                                 // an opcode that is none
      masked(0xF1, 1, "x"),                                                 // reserved bits
      masked(0x80, 1, "x"),                                                 // continues nothing
      masked(0x89, 126, std::string("\x01\x00", 2)),                        // a ping that is too long
      masked(0x08, 0, ""),                                                  // a close in fragments
      masked(0x88, 1, "x"),                                                 // a close with half a reason
      masked(0x88, 2, std::string("\x00\x01", 2)),                          // a close with a code that is none
      masked(0x81, 2, "\xff\xff"),                                          // no UTF-8
      std::string("\x81\xff\xff\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14),  // 2^64 bytes
      std::string("\x81\xff\0\0\0\0\0\x02\0\0\0\0\0\0", 14) + std::string(131'072, 'x'),  // 128 KiB without the token
  };
  for (const std::string& frame : frames) {
    LiveClient client(peer);
    client.client().send(frame);
    const auto rest = client.client().receive_all();
    EXPECT_TRUE(rest) << "the connection is still open";
  }
  EXPECT_GT(peer.counter("gateway.refused_malformed"), 5U);
  EXPECT_GE(peer.counter("gateway.refused_body_too_long"), 1U);
  expect_alive(peer);
}

TEST_F(GatewayAbuse, MessagesThatAreNoRequestsAreRefused) {
  ServedPeer peer(kWorld, {"CAR"});
  LiveClient client(peer);
  for (const char* text : {"", "null", "[]", "{", R"({"do":"watch","hz":1e9})", R"({"do":"pick","origin_m":["x"]})",
                           R"({"do":"inspect","node":4000000000})", R"({"do":"token"})", R"({"seq":-1})"}) {
    client.send_text(text);
    ASSERT_TRUE(client.read());
  }
  client.stream().binary(true);
  client.stream().write(boost::asio::buffer("\x01\x02", 2));
  EXPECT_EQ(client.ask({{"do", "status"}})["ok"], true);
  EXPECT_GT(peer.counter("gateway.refused_malformed"), 5U);
  expect_alive(peer);
}

// A client that watches and does not read: the peer's ticks go on, one frame waits for it, and when it reads again it
// soon has the present.
TEST_F(GatewayAbuse, ASlowReaderGetsTheNewestStateLater) {
  constexpr int kObjects = 500;
  ServedPeer peer(crowd(kObjects), names(kObjects));
  LiveClient slow(peer), other(peer);
  peer.await_start();
  EXPECT_EQ(slow.ask({{"do", "watch"}, {"hz", 120}})["ok"], true);
  EXPECT_TRUE(ServedPeer::soon([&] { return peer.counter("gateway.frames_late") > 0; })) << "its frames wait by now";
  const std::uint64_t ticks = peer.counter("ticks"), missed = peer.counter("ticks_missed");
  const std::uint64_t frames = peer.counter("gateway.frames");
  EXPECT_TRUE(ServedPeer::soon([&] { return peer.counter("ticks") > ticks + 60; }));
  EXPECT_LE(peer.counter("gateway.frames"), frames + 1) << "nothing is queued for who does not read";
  RecordProperty("ticks_missed", static_cast<int>(peer.counter("ticks_missed") - missed));
  EXPECT_EQ(other.ask({{"do", "status"}})["ok"], true);
  const auto session_s = [&] {
    return peer.in_its_thread([&] { return to_seconds(peer.session_now().time_since_epoch()); });
  };
  const double now_s = session_s();
  double seen_s = 0.0;
  for (int read = 0; read < 1000 && seen_s < now_s; ++read) {
    const std::string frame = slow.next_frame();
    ASSERT_GE(frame.size(), view::kPoseFrameHeader_bytes);
    std::memcpy(&seen_s, frame.data() + 8, sizeof(seen_s));
  }
  EXPECT_GE(seen_s, now_s);
}

}  // namespace peerd::gateway::http_connection_test
