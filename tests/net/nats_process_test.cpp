// The real program through real NATS servers: one, one that dies, and two of which one is the other's leaf node.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/wire.hpp"
#include "tests/peerd/net/nats/nats_server.hpp"

namespace peerd::nats_process_test {

using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::NatsServer;
using testing_support::Process;

using Words = std::vector<std::string>;

class NatsProcess : public testing_support::ControlledPeers {
 protected:
  void SetUp() override {
    if (!testing_support::has_nats_server()) GTEST_SKIP() << "nats-server is not installed";
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
  }
  Process peer(const std::string& name, Words words, const std::string& server) const {
    words.insert(words.end(), {"--interface", "lo", "--store", (folder / (name + ".store")).string(), "--take-over"});
    if (!server.empty()) words.insert(words.end(), {"--nats", server});
    return start(name, words);
  }
  Process run(const std::string& name, const std::string& server) const {
    return peer(name, {"run", "--world", (folder / "w.wrl").string(), "--world-name", world}, server);
  }

  const std::string world = "nats-" + std::to_string(getpid());
};

TEST_F(NatsProcess, TwoShareAWorldAndAThirdJoinsIt) {
  NatsServer server(folder, "server");
  Process a = run("a", server.url()), b = run("b", server.url());
  ASSERT_TRUE(is_in_session("a") && is_in_session("b")) << a.out() << a.err() << b.out() << b.err();
  ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out();
  EXPECT_THAT(a.out(), AllOf(HasSubstr("NATS subjects peerd." + world + ".any.0"), HasSubstr(server.url()),
                             HasSubstr("sealed")));
  ASSERT_TRUE(add("a", "BALL") && add("b", "CONE")) << a.err() << b.err();
  expect_one_world({"a", "b"}, {"BALL", "CONE"}, "two edits");
  // The third one is told by the peer that gives it the world which server that is.
  const std::string said = a.out();
  const std::string at = "by TCP";
  const auto port_at = said.rfind("port ", said.find(at)) + 5;
  const std::string port = said.substr(port_at, said.find(' ', port_at) - port_at);
  Process c = peer("c", {"join", world, "--from", "127.0.0.1:" + port}, "");
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  EXPECT_THAT(c.out(), HasSubstr(server.url()));
  ASSERT_TRUE(add("c", "CUBE")) << c.err();
  expect_one_world({"a", "b", "c"}, {"BALL", "CONE", "CUBE"}, "an edit by the third");
}

// An edit that was acknowledged while no server was there is nobody's loss.
TEST_F(NatsProcess, AServerThatDiesAndComesBackLosesNothing) {
  NatsServer server(folder, "server");
  Process a = run("a", server.url()), b = run("b", server.url());
  ASSERT_TRUE(is_in_session("a") && is_in_session("b")) << a.out() << b.out();
  ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out();
  server.kill();
  ASSERT_TRUE(a.says("the NATS server is gone", 20)) << a.out();
  ASSERT_TRUE(add("a", "BALL") && add("b", "CONE")) << a.err() << b.err();
  EXPECT_THAT(world_of("b"), Not(HasSubstr("BALL")));
  server.start();
  expect_one_world({"a", "b"}, {"BALL", "CONE"}, "the server's restart");
  EXPECT_TRUE(a.says("goes on by NATS server " + server.url(), 5)) << a.out();
}

// Two sites with a server each: the wire between them is cut and healed.
TEST_F(NatsProcess, TwoSitesThatWereCutApartBecomeOneWorld) {
  with_wire([&](const Wire& wire) {
    wire.right.enter();
    NatsServer hub(folder, "hub", "leafnodes { listen: \"0.0.0.0:7422\" }\n");
    Process b = run("b", hub.url());
    wire.left.enter();
    NatsServer leaf(folder, "leaf", "leafnodes { reconnect: 1, remotes: [{ url: \"nats-leaf://192.0.2.2:7422\" }] }\n");
    Process a = run("a", leaf.url());
    ASSERT_TRUE(is_in_session("a") && is_in_session("b")) << a.out() << b.out();
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out() << leaf.log();
    ASSERT_TRUE(add("a", "FIRST"));
    expect_one_world({"a", "b"}, {"FIRST"}, "an edit");
    ASSERT_TRUE(shell("ip link set va down"));
    ASSERT_TRUE(add("a", "BALL") && add("b", "CONE")) << a.err() << b.err();
    // Each side misses the other one: the cut has lasted.
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 0 && members_of("b") == 0; })) << a.out();
    ASSERT_TRUE(add("a", "CUBE") && add("b", "CYLINDER")) << a.err() << b.err();
    EXPECT_THAT(world_of("b"), Not(HasSubstr("BALL")));
    ASSERT_TRUE(shell("ip link set va up"));
    expect_one_world({"a", "b"}, {"FIRST", "BALL", "CONE", "CUBE", "CYLINDER"}, "the wire's healing");
  });
}

TEST_F(NatsProcess, ContradictionsAreWrongSettings) {
  const auto error_of = [&](const Words& sets, const std::string& server) {
    Words words{"run", "--world", (folder / "w.wrl").string()};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    Process a = peer("a", words, server);
    EXPECT_EQ(a.exit_code(20), 2) << a.out();
    return a.err();
  };
  EXPECT_THAT(error_of({"transport.multicast=always"}, "nats://127.0.0.1"),
              HasSubstr("transport.multicast contradicts transport.nats"));
  EXPECT_THAT(error_of({}, "http://127.0.0.1"), HasSubstr("transport.nats: server 1 of the list is no nats://"));
}

}  // namespace peerd::nats_process_test
