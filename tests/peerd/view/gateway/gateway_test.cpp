// A real peer, asked by HTTP over loopback.
#include "peerd/view/gateway/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/peerd/view/gateway/served_peer.hpp"
#include "tests/peerd/view/gateway/web_client.hpp"

namespace peerd::gateway::gateway_test {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing_support::ServedPeer;
using testing_support::WebClient;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { appearance Appearance { material Material { } } geometry Box { } } }
DEF FREE Transform { translation 0 5 0 children Shape { geometry Box { } } }
DEF PUSH KeySensor { recipient "CAR" keyValue 65 value 2 0 0 }
)";

class GatewayTest : public testing::Test {
 protected:
  ServedPeer peer{kWorld, {"CAR"}};
};

std::string header(const WebClient::Response& response, const char* name) { return std::string(response[name]); }

TEST_F(GatewayTest, EachPlaceAnswers) {
  WebClient client(peer);
  for (const char* target : {"/api/v1/status", "/api/v1/peers?from=0", "/api/v1/objects?from=0&count=2",
                             "/api/v1/conflicts?from=0", "/api/v1/world", "/api/v1/data?path=CAR"}) {
    const auto response = client.get(target);
    EXPECT_EQ(response.result_int(), 200U) << target;
    EXPECT_EQ(header(response, "Content-Type"), "application/json");
    EXPECT_EQ(json::parse(response.body())["ok"], true) << response.body();
  }
  EXPECT_EQ(json::parse(client.get("/api/v1/status").body())["peer"]["name"], "a");
  EXPECT_EQ(json::parse(client.get("/api/v1/recording").body()),
            (json{{"v", 1}, {"ok", true}, {"recording", nullptr}}));
  EXPECT_EQ(client.get("/api/v1/recording/0/events").result_int(), 404U);
  EXPECT_EQ(json::parse(client.request("POST", "/api/v1/request", {}, R"({"do":"viewer"})").body())["ok"], false)
      << "the address has the token";
  const auto metrics = client.get("/metrics");
  EXPECT_EQ(header(metrics, "Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_THAT(metrics.body(), HasSubstr("\npeerd_gateway_connections_total 1\n"));
  EXPECT_THAT(metrics.body(), HasSubstr("\npeerd_ticks_total "));
  EXPECT_THAT(client.get("/").body(), HasSubstr("has no viewer"));
  EXPECT_EQ(peer.connections(), 1U) << "one connection has served all";
}

TEST_F(GatewayTest, TheStatusIsTheControlProtocolsWithTheGatewaysCounters) {
  WebClient client(peer);
  const json counters = json::parse(client.get("/api/v1/status").body())["counters"];
  EXPECT_EQ(counters["gateway.requests"], 1);
  EXPECT_TRUE(counters.contains("net.packets_in"));
  EXPECT_TRUE(counters.contains("ticks"));
  const json by_post = json::parse(client.post({{"do", "status"}}).body());
  EXPECT_EQ(by_post["ok"], true) << "which needs no token";
}

TEST_F(GatewayTest, AnswersSayWhatABrowserMayDoWithThem) {
  WebClient client(peer);
  for (const char* target : {"/", "/api/v1/status", "/api/v1/nothing"}) {
    const auto response = client.get(target);
    EXPECT_EQ(header(response, "X-Content-Type-Options"), "nosniff");
    EXPECT_THAT(header(response, "Content-Security-Policy"), HasSubstr("default-src 'self';"));
    EXPECT_THAT(header(response, "Content-Security-Policy"), Not(HasSubstr("unsafe-eval")));
    EXPECT_EQ(header(response, "Access-Control-Allow-Origin"), "");
    EXPECT_EQ(header(response, "Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_THAT(response.body(), Not(HasSubstr(ServedPeer::kToken)));
  }
}

TEST_F(GatewayTest, TheSceneIsGltfAndIsNotSentTwice) {
  WebClient client(peer);
  const auto scene = client.get("/api/v1/scene.glb");
  EXPECT_EQ(scene.result_int(), 200U);
  EXPECT_EQ(header(scene, "Content-Type"), "model/gltf-binary");
  ASSERT_GT(scene.body().size(), 20U);
  EXPECT_EQ(scene.body().substr(0, 4), "glTF");
  EXPECT_THAT(scene.body(), HasSubstr("\"CAR\""));
  const std::string tag = header(scene, "ETag");
  const auto again = client.get("/api/v1/scene.glb", {{"If-None-Match", tag}});
  EXPECT_EQ(again.result_int(), 304U);
  EXPECT_EQ(again.body(), "");
  EXPECT_EQ(header(client.get("/api/v1/scene.glb", {{"If-None-Match", "\"other-1\""}}), "ETag"), tag);
}

TEST_F(GatewayTest, WhatChangesSomethingNeedsTheToken) {
  const std::vector<json> requests{{{"do", "key"}, {"key", "a"}},
                                   {{"do", "pose"}, {"object", "CAR"}, {"position_m", {1, 2, 3}}},
                                   {{"do", "set"}, {"path", "FREE"}, {"field", "translation"}, {"value", "1 1 1"}},
                                   {{"do", "add"}, {"text", "DEF NEW Transform { }"}},
                                   {{"do", "remove"}, {"path", "FREE"}},
                                   {{"do", "own"}, {"path", "FREE"}},
                                   {{"do", "data"}, {"path", "CAR"}, {"key", "k"}, {"value", "v"}},
                                   {{"do", "send"}, {"topic", "t"}, {"text", "x"}},
                                   {{"do", "undo"}},
                                   {{"do", "leave"}}};
  const std::string token = ServedPeer::kToken;
  WebClient client(peer);
  for (const json& request : requests) {
    for (const std::string& wrong :
         {std::string(), std::string("x"), token.substr(1), token + "m", "1" + token.substr(1)}) {
      const auto response = client.post(request, wrong);
      EXPECT_EQ(response.result_int(), 401U) << request << wrong;
      EXPECT_EQ(header(response, "WWW-Authenticate"), "Bearer");
      EXPECT_THAT(response.body(), Not(HasSubstr(token)));
    }
  }
  EXPECT_EQ(peer.counter("operations"), 0U);
  EXPECT_EQ(peer.counter("keys"), 0U);
  EXPECT_EQ(peer.counter("gateway.refused_token"), 5 * requests.size());
  peer.await_start();
  EXPECT_EQ(json::parse(client.post(requests[3], token).body())["done"], true);
  EXPECT_EQ(peer.counter("operations"), 1U);
  EXPECT_EQ(client.get("/api/v1/status").result_int(), 200U) << "it has not left";
}

TEST_F(GatewayTest, TheReplyToLeaveIsOutBeforeThePeerLeaves) {
  WebClient client(peer);
  const auto response = client.post({{"do", "leave"}}, ServedPeer::kToken);
  EXPECT_EQ(response.result_int(), 200U);
  EXPECT_EQ(peer.wait(), 0);
}

struct Refused {
  const char *name, *method, *target;
  WebClient::Headers headers;
  unsigned status;
  const char* counter;
};
class Refusals : public GatewayTest, public testing::WithParamInterface<Refused> {};
TEST_P(Refusals, AreCountedAndLoggedOnce) {
  const Refused& c = GetParam();
  for (int times = 0; times < 2; ++times) {
    WebClient client(peer);
    const auto response = client.request(c.method, c.target, c.headers);
    EXPECT_EQ(response.result_int(), c.status);
    EXPECT_EQ(json::parse(response.body())["ok"], false);
  }
  EXPECT_EQ(peer.counter(c.counter), 2U);
  const std::string said = peer.said();
  const auto first = said.find("gateway: ");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(said.find("gateway: ", first + 1), std::string::npos) << said;
}
INSTANTIATE_TEST_SUITE_P(
    Table, Refusals,
    testing::Values(
        Refused{"Rebinding", "GET", "/api/v1/status", {{"Host", "attacker.example"}}, 421, "gateway.refused_host"},
        Refused{"RebindingWithPort", "GET", "/", {{"Host", "attacker.example:1"}}, 421, "gateway.refused_host"},
        Refused{"TwoHosts", "GET", "/", {{"Host", "127.0.0.1"}, {"Host", "localhost"}}, 421, "gateway.refused_host"},
        Refused{"OtherOrigin",
                "GET",
                "/api/v1/status",
                {{"Origin", "http://attacker.example"}},
                403,
                "gateway.refused_origin"},
        Refused{"NullOrigin", "POST", "/api/v1/request", {{"Origin", "null"}}, 403, "gateway.refused_origin"},
        Refused{"LiveFromElsewhere",
                "GET",
                "/api/v1/live",
                {{"Origin", "http://attacker.example"},
                 {"Upgrade", "websocket"},
                 {"Connection", "Upgrade"},
                 {"Sec-WebSocket-Version", "13"},
                 {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="}},
                403,
                "gateway.refused_origin"},
        Refused{"Traversal", "GET", "/assets/../../../etc/passwd", {}, 404, "gateway.refused_not_found"},
        Refused{"EncodedTraversal", "GET", "/assets/%2e%2e/%2e%2e/etc/passwd", {}, 404, "gateway.refused_not_found"},
        Refused{"Nothing", "GET", "/api/v1/nothing", {}, 404, "gateway.refused_not_found"},
        Refused{"Method", "DELETE", "/api/v1/status", {}, 405, "gateway.refused_method"},
        Refused{"Preflight", "OPTIONS", "/api/v1/request", {}, 405, "gateway.refused_method"},
        Refused{"Parameter", "GET", "/api/v1/objects?count=x", {}, 400, "gateway.refused_malformed"},
        Refused{"NoUpgrade", "GET", "/api/v1/live", {}, 400, "gateway.refused_malformed"},
        Refused{"LongHeader", "GET", "/", {{"X", std::string(9000, 'x')}}, 431, "gateway.refused_header_too_long"},
        Refused{"LongBody",
                "POST",
                "/api/v1/request",
                {{"Content-Length", "70000"}},
                413,
                "gateway.refused_body_too_long"}),
    [](const auto& refused) { return std::string(refused.param.name); });

// A page of this server has its own origin, and a page of another port has not.
TEST_F(GatewayTest, ItsOwnPageMayAsk) {
  WebClient client(peer);
  EXPECT_EQ(client.get("/api/v1/status", {{"Origin", "http://" + peer.host()}}).result_int(), 200U);
  const std::string localhost = "localhost:" + std::to_string(peer.port());
  EXPECT_EQ(client.get("/api/v1/status", {{"Host", localhost}, {"Origin", "http://" + localhost}}).result_int(), 200U);
  EXPECT_EQ(client.get("/api/v1/status", {{"Origin", "http://127.0.0.1:1"}}).result_int(), 403U);
}

// A page of an origin that the configuration names may read what it asks for; the next request of the connection is
// anew.
TEST_F(GatewayTest, APageOfANamedOriginMayAsk) {
  WebClient client(peer);
  const auto answer = client.get("/api/v1/scene.glb", {{"Origin", ServedPeer::kOtherOrigin}});
  EXPECT_EQ(answer.result_int(), 200U);
  EXPECT_EQ(header(answer, "Access-Control-Allow-Origin"), ServedPeer::kOtherOrigin);
  EXPECT_THAT(header(answer, "Vary"), HasSubstr("Origin"));
  EXPECT_EQ(header(client.get("/api/v1/status"), "Access-Control-Allow-Origin"), "");
  EXPECT_EQ(header(client.get("/api/v1/status", {{"Origin", "http://" + peer.host()}}), "Access-Control-Allow-Origin"),
            "");
  const auto other = client.get("/api/v1/status", {{"Origin", std::string(ServedPeer::kOtherOrigin) + "0"}});
  EXPECT_EQ(other.result_int(), 403U);
  EXPECT_EQ(header(other, "Access-Control-Allow-Origin"), "");
}

TEST_F(GatewayTest, ALongBodyNeedsTheToken) {
  const json request{{"do", "send"}, {"topic", "t"}, {"text", std::string(100'000, 'x')}};
  WebClient without(peer), with(peer);
  EXPECT_EQ(without.post(request).result_int(), 413U);
  const auto response = with.post(request, ServedPeer::kToken);
  EXPECT_EQ(response.result_int(), 200U);
  EXPECT_EQ(json::parse(response.body())["done"], false) << "a message has 16,384 bytes at most";
}

TEST_F(GatewayTest, ASecondGatewayOfThePortSaysSo) {
  boost::asio::io_context io;
  const auto opened = peer.in_its_thread([&] {
    Gateway::Options options;
    options.at = {boost::asio::ip::address_v4::loopback(), peer.port()};
    const auto second = Gateway::open(io, peer.source(), options);
    return second ? std::string() : second.error().text;
  });
  EXPECT_THAT(opened, HasSubstr("Address already in use"));
}

}  // namespace peerd::gateway::gateway_test
