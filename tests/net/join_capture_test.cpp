// A session of real processes with a join, a snapshot and edits of many kinds: captures of peers that were recorded in
// it replay byte for byte, and Wireshark reads all that was on the wire as our own readers do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <thread>

#include <nlohmann/json.hpp>

#include "peerd/peer/record/capture.hpp"
#include "replication/wire/codec.hpp"
#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/net/wire.hpp"
#include "tests/sim/dissector/wire.hpp"

namespace peerd::join_capture_test {

using net::testing_support::Namespace;
using net::testing_support::own_port;
using net::testing_support::shell;
using nlohmann::json;
using testing_support::Process;
using testing_support::text_of;

using Words = std::vector<std::string>;

constexpr const char* kDumpcap = "/usr/bin/dumpcap";

class CapturedJoin : public testing_support::ControlledPeers {
 protected:
  CapturedJoin() {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
  }

  // A peer with a capture.
  [[nodiscard]] Process record(const std::string& name, const Words& more) const {
    Words words{"record", "--open", "--interface",       "lo", "--world", (folder / "w.wrl").string(), "--world-name",
                world,    "--out",  file(name, "pcapng")};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  [[nodiscard]] Process join(const std::string& name) const {
    return start(name, {"join", world, "--open", "--interface", "lo"});
  }
  [[nodiscard]] bool have_the_same(const std::string& a, const std::string& b) const {
    return wait_until([&] { return !world_of(a).empty() && world_of(a) == world_of(b); });
  }
  // An edit takes effect a little later; the next one may need it.
  void edit(const std::string& name, const json& request) const {
    const json reply = ask(name, request);
    ASSERT_TRUE(reply.is_object() && reply.value("done", false)) << request << " " << reply;
    json question = reply.at("operation");
    question["do"] = "operation";
    const auto applied = [&] {
      const json now = ask(name, question);
      return now.is_object() && now.value("applied", false);
    };
    EXPECT_TRUE(wait_until(applied)) << request << " " << reply;
  }
  [[nodiscard]] static json add_of(const std::string& def) {
    return {{"do", "add"}, {"text", "DEF " + def + " Transform { children Shape { geometry Sphere { } } }"}};
  }
  // What is longer than a datagram.
  [[nodiscard]] static json add_of_much() {
    std::string points;
    for (int i = 0; i < 1000; ++i) points += std::to_string(i) + " 0.25 " + std::to_string(i * i % 97) + ", ";
    return {{"do", "add"},
            {"text", "DEF MUCH Shape { geometry PointSet { coord Coordinate { point [" + points + "] } } }"}};
  }
  // What a joining peer gets by TCP.
  void edit_alone() const {
    edit("a", add_of("ALONE"));
    edit("a", add_of("TAKEN"));
  }
  // What peers a and b send each other.
  void edit_together() const {
    edit("b", add_of("BALL"));
    edit("b", {{"do", "set"}, {"path", "BALL"}, {"field", "translation"}, {"value", "1 2 3"}});
    edit("a", add_of_much());
    ASSERT_TRUE(have_the_same("a", "b"));
    edit("b", {{"do", "move"}, {"path", "BALL"}, {"under", "TAKEN"}});
    edit("a", {{"do", "own"}, {"path", "TAKEN"}});
    edit("b", {{"do", "own"}, {"path", "TAKEN"}});  // a gives it
    edit("b", {{"do", "release"}, {"path", "TAKEN"}});
    edit("b", {{"do", "data"}, {"path", "CAR"}, {"key", "seat"}, {"value", "3"}});
    edit("b", {{"do", "data"}, {"path", "CAR"}, {"key", "seat"}, {"remove", true}});
    edit("b", {{"do", "undo"}});
    edit("b", {{"do", "redo"}});
    edit("a", {{"do", "send"}, {"topic", "chat"}, {"text", "hello, all"}});
    edit("a", {{"do", "remove"}, {"path", "ALONE"}});
    ASSERT_TRUE(have_the_same("a", "b"));
  }
  [[nodiscard]] bool leaves(Process& peer, const std::string& name) const {
    (void)ask(name, {{"do", "leave"}});
    return peer.exit_code(30) == 0;
  }
  [[nodiscard]] json replay(const std::string& name) const {
    Process p(folder, "replay-" + name, PEERD_PROGRAM, {"replay", file(name, "pcapng"), "--json"});
    EXPECT_EQ(p.exit_code(30), 0) << p.out() << p.err();
    return json::parse(p.out(), nullptr, false);
  }
  [[nodiscard]] std::string file(const std::string& name, const std::string& kind) const {
    return (folder / (name + "." + kind)).string();
  }

  const std::string world = "captured-" + std::to_string(getpid());
};

struct Seen {
  std::size_t parts_in = 0, parts_out = 0, requests_in = 0, requests_out = 0, control = 0;
};

Seen seen_in(const std::string& path) {
  Seen seen;
  const std::string bytes = text_of(path);
  auto capture = record::CaptureReader::open(std::as_bytes(std::span(bytes)));
  if (!capture) ADD_FAILURE() << capture.error();
  while (capture) {
    const auto event = capture->next();
    if (!event) ADD_FAILURE() << event.error();
    if (!event || !*event) break;
    seen.control += std::holds_alternative<record::Control>((*event)->what);
    const auto* in = std::get_if<record::DatagramIn>(&(*event)->what);
    const auto* out = std::get_if<record::DatagramOut>(&(*event)->what);
    if (!in && !out) continue;
    const auto m = replication::decode(in ? in->datagram : out->datagram, SimTime{(*event)->at.time_since_epoch()});
    if (!m) ADD_FAILURE() << "a datagram that peers refuse";
    if (!m) continue;
    (in ? seen.parts_in : seen.parts_out) += m->operations.size();
    (in ? seen.requests_in : seen.requests_out) += m->operation_requests.size();
  }
  return seen;
}

// Peer a gives its world to b, which joins, and both edit it. Then c begins with the file and asks for all edits.
TEST_F(CapturedJoin, RecordedPeersReplayByteForByte) {
  const Words port{"--port", std::to_string(own_port(15))};
  Process a = record("a", port);
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
  edit_alone();
  Process b = join("b");
  ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
  ASSERT_TRUE(have_the_same("a", "b"));
  edit_together();
  Process c = record("c", port);
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  ASSERT_TRUE(have_the_same("a", "c"));
  edit("c", add_of("LATE"));
  ASSERT_TRUE(have_the_same("c", "b"));
  EXPECT_TRUE(leaves(c, "c") && leaves(a, "a") && leaves(b, "b"));

  const Seen of_a = seen_in(file("a", "pcapng")), of_c = seen_in(file("c", "pcapng"));
  EXPECT_GT(of_a.parts_in, 5u);
  EXPECT_GT(of_a.parts_out, 10u) << "one edit is longer than ten datagrams";
  EXPECT_GT(of_a.requests_in, 0u) << "of c";
  EXPECT_GT(of_a.control, 10u);
  EXPECT_GT(of_c.requests_out, 0u);
  EXPECT_GT(of_c.parts_in, 10u);
  EXPECT_GT(of_c.parts_out, 0u);
  for (const char* name : {"a", "c"}) {
    const json outcome = replay(name);
    EXPECT_EQ(outcome["same"], true) << outcome;
    EXPECT_GT(outcome["datagrams_out"], 10) << outcome;
    EXPECT_GT(outcome["datagrams_in"], 10) << outcome;
  }
}

// In a network namespace of its own, so that nothing else is on the wire; it ends with the thread.
void in_a_namespace(const std::function<void()>& body) {
  std::string problem;
  std::thread([&] {
    const Namespace alone;
    problem = alone.problem();
    if (!problem.empty()) return;
    ASSERT_TRUE(shell("ip link set lo up && ip route add 224.0.0.0/4 dev lo"));
    body();
  }).join();
  if (!problem.empty()) GTEST_SKIP() << "no network namespaces here: " << problem;
}

TEST_F(CapturedJoin, WiresharkReadsAllOfIt) {
  using namespace sim::dissector_test;
  for (const char* program : {kTshark, kDumpcap}) {
    if (!std::filesystem::exists(program)) GTEST_SKIP() << kNoTshark;
  }
  std::map<std::string, std::size_t> seen;
  in_a_namespace([&] {
    Process dumpcap(folder, "dumpcap", kDumpcap, {"-q", "-B", "64", "-i", "lo", "-w", file("wire", "pcapng")});
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(file("wire", "pcapng")); })) << dumpcap.err();
    Process a = record("a", {});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    edit_alone();
    Process ls(folder, "ls", PEERD_PROGRAM, {"ls", "--interface", "lo"});
    EXPECT_EQ(ls.exit_code(30), 0) << ls.err();
    Process b = join("b");
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    ASSERT_TRUE(have_the_same("a", "b"));
    edit_together();
    EXPECT_TRUE(leaves(b, "b") && leaves(a, "a"));
    dumpcap.signal(SIGINT);
    EXPECT_EQ(dumpcap.exit_code(30), 0) << dumpcap.err();
    compare_wire(folder, file("wire", "pcapng"), seen);
    EXPECT_EQ(replay("a")["same"], true);
  });
  if (seen.empty()) return;
  for (const char* name :
       {"peerd.beacon.world", "peerd_join.world", "peerd_join.chunk.bytes", "peerd_join.range.to", "peerd.log.bytes",
        "peerd.identity.asker", "peerd.introduction.name", "peerd.operation.text", "peerd.operation.value",
        "peerd.operation.owner", "peerd.operation.by", "peerd.operation.data", "peerd.operation.message",
        "peerd.operation.undone.number", "peerd.operation.redoes"}) {
    EXPECT_GT(seen[name], 0u) << name;
  }
  for (const char* name : {kMalformed, kMalformedJoin, kUnreadable, kForked, kUnknown})
    EXPECT_EQ(seen[name], 0u) << name;
}

}  // namespace peerd::join_capture_test
