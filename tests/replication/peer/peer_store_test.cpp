// Peers that begin with the operations that a store holds: all leave, all come back, and the scene is what it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/peers.hpp"

namespace peerd::replication::peer_store_test {

using namespace test;
using testing::IsEmpty;

const std::string kHead = "#VRML V2.0 utf8\n";

// The part of a driver with a store: it keeps what LogGrown says, here in memory and for each peer.
class Stores : public Peers {
 protected:
  Stores() : Peers(box("BALL", "1 1 1", "0 0 0") + box("CAR", "1 1 1", "0 20 0"), {"BALL", "CAR"}) {}

  [[nodiscard]] static AuthorId author(std::size_t i) { return AuthorId{static_cast<std::uint32_t>(41 + i)}; }
  // Starts these peers, each with the log in its store. Other members number peers by their place in `here`.
  void begin(std::vector<std::size_t> who = {0, 1, 2}, Duration clocks_ahead = 0s) {
    lan = std::make_unique<Lan>(world, Link{.latency = 20ms}, 1);
    here = std::move(who);
    for (const std::size_t i : here) {
      PeerConfig c = config(static_cast<std::uint32_t>(i + 1));
      c.author = author(i);
      c.log.parts = stored[i];
      if (i == 0) c.owned = {{world["BALL"]}};
      lan->add(c, clocks_ahead);
    }
    lan->run_until(3s);
  }
  // All leave, and their stores have what they said.
  void end() {
    run_on(2s);
    for (std::size_t i = 0; i < lan->size(); ++i) {
      for (const LogGrown& grown : lan->seen<LogGrown>(i)) {
        const auto bytes = lan->peer(i).log_bytes(grown.range);
        EXPECT_EQ(bytes.size(), grown.range.to - grown.range.from);
        stored[here[i]].push_back({grown.range.author, grown.range.from, {bytes.begin(), bytes.end()}});
      }
    }
    lan.reset();
  }
  AddNodes adding(const std::string& name, int x) const {
    return {{}, {}, kHead + box(name, "1 1 1", std::to_string(x) + " 0 0"), 0, 0, {}};
  }

  std::vector<std::size_t> here;
  std::vector<std::vector<OperationPart>> stored{3};
};

TEST_F(Stores, WhatAllHaveLeftIsThereWhenTheyComeBack) {
  begin();
  (void)edit(0, adding("A", 10));
  (void)edit(1, adding("B", 20));
  run_on(1s);
  (void)edit(2, RemoveObject{scene(2).find("A").value()});
  run_on(1s);
  const std::string before = text_at(0);
  end();
  begin();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(text_at(i), before) << "peer " << i + 1;
    EXPECT_THAT(lan->seen<LogGrown>(i), IsEmpty()) << "all of it was stored";
    EXPECT_EQ(lan->drops(i, "forked_log") + lan->drops(i, "own_log"), 0U);
  }
}

TEST_F(Stores, OwnersAreWhatTheyWere) {
  begin();
  ASSERT_TRUE(lan->peer(0).give(lan->host_now(0), world["BALL"], PeerId{2}));  // which a configuration gives to peer 1
  ASSERT_TRUE(lan->peer(2).own(lan->host_now(2), world["CAR"]));
  run_on(1s);
  end();
  begin();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lan->peer(i).owner(world["BALL"]), PeerId{2}) << "peer " << i + 1;
    EXPECT_EQ(lan->peer(i).owner(world["CAR"]), PeerId{3}) << "peer " << i + 1;
  }
  EXPECT_FALSE(lan->peer(0).owns_any());
  EXPECT_TRUE(lan->peer(2).change_velocity(lan->host_now(2), world["CAR"], Vec3(1, 0, 0), true));
}

// Peers that have never met have changed one world, each for itself. When they meet, all has happened to it that has
// happened to either, for all of them.
TEST_F(Stores, TwoLogsOfOneWorldMerge) {
  begin({0});
  (void)edit(0, adding("A", 10));
  end();
  begin({1});
  (void)edit(0, adding("B", 20));
  run_on(1s);
  (void)edit(0, RemoveObject{scene().find("CAR").value()});
  end();
  begin({2});
  (void)edit(0, adding("C", 30));
  end();
  begin();
  run_on(2s);
  for (std::size_t i = 0; i < 3; ++i) {
    for (const char* const name : {"BALL", "A", "B", "C"})
      EXPECT_TRUE(scene(i).find(name)) << name << ", peer " << i + 1;
    EXPECT_FALSE(scene(i).find("CAR")) << "peer " << i + 1;
    EXPECT_EQ(text_at(i), text_at(0)) << "peer " << i + 1;
    EXPECT_EQ(lan->drops(i, "forked_log") + lan->drops(i, "own_log"), 0U);
  }
  const std::string merged = text_at(0);
  end();
  for (std::size_t i = 0; i < 3; ++i) {
    begin({i});
    EXPECT_EQ(text_at(0), merged) << "peer " << i + 1 << " alone, by its store";
    end();
  }
}

// The ids of an operation that changes nothing are used all the same: elsewhere it has done what it says.
TEST_F(Stores, IdsOfWhatChangesNothingAreNotUsedAgain) {
  begin({0, 1});
  const auto make_parent = edit(1, adding("PARENT", 10));
  run_on(1s);
  AddNodes child = adding("CHILD", 1);
  child.parent = scene().find("PARENT").value();
  (void)edit(0, child);
  run_on(1s);
  const ObjectId first = scene(1).find("PARENT/CHILD").value();
  end();
  std::erase_if(stored[0], [&](const OperationPart& part) { return part.author == make_parent.author; });
  begin({0});
  EXPECT_EQ(scene().find("PARENT"), std::nullopt);
  EXPECT_FALSE(scene().contains(first));
  (void)edit(0, adding("NEXT", 30));
  run_on(1s);
  EXPECT_GT(scene().find("NEXT").value().number, first.number);
  end();
  begin({0, 1});
  run_on(2s);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(scene(i).find("PARENT/CHILD"), first) << "peer " << i + 1;
    EXPECT_TRUE(scene(i).find("NEXT")) << "peer " << i + 1;
  }
}

// An object that was removed keeps its ids to itself, in the next life of its author, too.
TEST_F(Stores, IdsOfAnAuthorGoOnBehindAllThatItHasUsed) {
  begin();
  (void)edit(0, adding("A", 10));
  run_on(1s);
  const ObjectId first = scene().find("A").value();
  (void)edit(0, RemoveObject{first});
  end();
  begin();
  EXPECT_EQ(scene().find("A"), std::nullopt);
  const OperationId id = edit(0, adding("A", 30));
  EXPECT_EQ(id, (OperationId{author(0), 3}));
  run_on(1s);
  const ObjectId second = scene(1).find("A").value();
  EXPECT_EQ(second.origin, author(0).value);
  EXPECT_GT(second.number, first.number);
  end();
  begin();
  EXPECT_EQ(scene(2).find("A"), second);
}

// The hosts' clocks show an hour less than when the world was left: its time goes on nevertheless.
TEST_F(Stores, AClockThatWentBackDelaysNothing) {
  begin({0, 1, 2}, 1h);
  (void)edit(0, adding("A", 10));
  run_on(1s);
  const SimTime left = lan->session_now(0);
  end();
  begin();
  EXPECT_GT(lan->session_now(0), left - 5s);
  EXPECT_TRUE(scene(2).find("A"));
  (void)edit(1, adding("B", 20));
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(scene(i).find("B")) << "peer " << i + 1;
}

// A receiver may have the operations as soon as LogGrown is out, and not before.
TEST_F(Stores, ALogGrowsBeforeAnythingOfItLeaves) {
  begin({0, 1});
  auto& peer = lan->peer(0);
  (void)edit(0, adding("A", 10));
  bool grown = false;
  while (const auto out = peer.poll_output()) {
    if (std::holds_alternative<LogGrown>(*out)) grown = true;
    if (const auto* const send = std::get_if<Send>(&*out)) {
      const auto message = decode(send->datagram, lan->session_now(0));
      ASSERT_TRUE(message);
      EXPECT_TRUE(grown || message->operations.empty());
    }
  }
  EXPECT_TRUE(grown);
}

}  // namespace peerd::replication::peer_store_test
