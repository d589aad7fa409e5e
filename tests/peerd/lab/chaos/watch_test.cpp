// The watches say what is wrong where something is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/chaos/watch/data_watch.hpp"
#include "peerd/lab/chaos/watch/message_watch.hpp"
#include "peerd/lab/chaos/watch/operation_book.hpp"
#include "peerd/lab/chaos/watch/ownership_watch.hpp"
#include "peerd/lab/chaos/world_text.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos::watch_test {

using namespace replication;
using config::SceneEdit;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class ChaosWatch : public testing::Test {
 protected:
  // Two peers that never hear each other; each founds a session of its own.
  ChaosWatch() {
    for (std::uint32_t id = 1; id <= 2; ++id) {
      const config::PeerSettings settings{.name = "p" + std::to_string(id), .id = id};
      nodes.push_back(PeerNode::make(settings, {}, *shared, {}, {}));
      peers.push_back({id - 1, id - 1, nodes.back().get()});
    }
    run_to_s(5.0);
  }
  void run_to_s(double to_s) {
    for (; now_s < to_s; now_s += 0.02) {
      for (const WatchedPeer& peer : peers) {
        nodes[peer.host]->on_tick(now());
        drain(peer);
      }
    }
  }
  void drain(const WatchedPeer& peer) {
    while (const auto output = nodes[peer.host]->poll_output()) {
      if (const auto* grown = std::get_if<LogGrown>(&*output))
        book.follow(peer.node->peer().logs(), grown->range.author);
      ownership.on_output(now_s, peer, *output);
      data.on_output(peer, *output);
    }
    ownership.end_outputs();
  }
  [[nodiscard]] HostTime now() const { return HostTime{from_seconds(now_s)}; }
  OperationId edit(std::size_t i, SceneEdit::Kind kind, const std::string& path, const std::string& value) {
    const SceneEdit edit{.kind = kind, .path = path, .key = "k", .data = value};
    const EditReport report = nodes[i]->edit(now(), edit);
    EXPECT_TRUE(report.operation) << report.refused;
    drain(peers[i]);
    data.on_edit(peers[i], report);
    ownership.on_edit(peers[i], report);
    return report.operation.value_or(OperationId{});
  }
  [[nodiscard]] const Scene& file() const { return shared->world.scene; }
  [[nodiscard]] ObjectId object(const char* path) const { return file().find(path).value(); }

  std::unique_ptr<const SharedWorld> shared = share(draw_world(1, 2));
  double now_s = 1.0;
  std::vector<std::unique_ptr<PeerNode>> nodes;
  std::vector<WatchedPeer> peers;
  OperationBook book;
  Findings findings;
  OwnershipWatch ownership{book, findings};
  DataWatch data{book, findings};
  MessageWatch messages{book, findings};
};

TEST_F(ChaosWatch, NothingIsWrongWithOneThatEditsAndUndoes) {
  edit(0, SceneEdit::Kind::kData, "S1", "a");
  edit(0, SceneEdit::Kind::kData, "S1", "b");
  run_to_s(6.0);
  edit(0, SceneEdit::Kind::kUndo, "", "");
  edit(0, SceneEdit::Kind::kOwn, "S1", "");
  run_to_s(7.0);
  const std::span alone(peers.data(), 1);
  data.finish(now_s, alone, &file());
  ownership.finish(now_s, alone);
  EXPECT_THAT(findings.violations(), IsEmpty());
  EXPECT_EQ(findings.branches().at("undo of data"), 1u);
  EXPECT_EQ(findings.branches().at("object taken from nobody"), 1u);
  EXPECT_EQ(findings.branches().at("owner by operations judged"), 1u);
}

TEST_F(ChaosWatch, PeersWithOtherDataOrOtherOwnersAreFound) {
  edit(0, SceneEdit::Kind::kData, "S1", "a");
  edit(0, SceneEdit::Kind::kOwn, "S1", "");
  run_to_s(7.0);
  data.finish(now_s, peers, &file());
  ownership.finish(now_s, peers);
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 2 has other data than peer 1")));
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 2 has other data than a scene that never had")));
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 2 says of operation")));
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 2 has operation none as the epoch of object")));
  EXPECT_THAT(findings.violations(),
              Contains(HasSubstr("S1 is peer 1's by operations, and for peer 2 it is peer 0's")));
}

TEST_F(ChaosWatch, WhoPublishesWhatIsNotItsOwnIsFound) {
  const replication::Published published{{}, object("S1"), 10, 0.1, {}};
  ownership.on_output(now_s, peers[0], published);
  ownership.on_output(now_s, peers[0], ObjectGiven{object("S1"), PeerId{1}, PeerId{2}, {}});
  ownership.end_outputs();
  EXPECT_THAT(findings.violations(), IsEmpty()) << "it was given away in the same call";
  ownership.on_output(now_s, peers[0], published);
  ownership.end_outputs();
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 1 has published object")));
}

TEST_F(ChaosWatch, AMessageArrivesOnceAsItWasSentAndWhereItsSenderIs) {
  const OperationId sent = edit(0, SceneEdit::Kind::kSend, "", "hello");
  messages.on_sent(peers[0], sent, peers);
  run_to_s(6.0);
  messages.finish(now_s, peers);
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("peer 1 was there when message")));
  EXPECT_THAT(findings.violations(), testing::SizeIs(1)) << "the other one was not";
  const MessageReceived received{sent, PeerId{1}, "k", "hello", {}};
  messages.on_received(now_s, peers[0], received);
  EXPECT_THAT(findings.violations(), testing::SizeIs(1));
  messages.on_received(now_s, peers[0], received);
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("twice")));
  messages.on_received(now_s, peers[1], {sent, PeerId{1}, "k", "hullo", {}});
  EXPECT_THAT(findings.violations(), Contains(HasSubstr("which nobody has sent so")));
}

// Chaos seed 20337: its author began again without it, and another operation got its number.
TEST_F(ChaosWatch, AMessageMayBeLostWithItsAuthor) {
  const OperationId sent = edit(0, SceneEdit::Kind::kSend, "", "hello");
  messages.on_sent(peers[0], sent, peers);
  book.cut(nodes[1]->peer().logs(), sent.author);
  messages.finish(now_s, peers);
  EXPECT_THAT(findings.violations(), IsEmpty()) << "nobody has it";
  const OperationId other = edit(1, SceneEdit::Kind::kSend, "", "hullo");
  messages.on_sent(peers[1], other, {&peers[1], 1});
  messages.on_sent(peers[1], other, {&peers[0], 1});
  messages.finish(now_s, {&peers[1], 1});
  EXPECT_THAT(findings.violations(), IsEmpty()) << "the later message of that number was not for this peer";
}

}  // namespace peerd::chaos::watch_test
