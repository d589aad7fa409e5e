#include "replication/peer/scene_keeper.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::scene_keeper_test {

using namespace test;

constexpr std::size_t kBalls = 900;

// Peer 5 among peers 3 and 9, in a session since 0 s. Many balls lie in a row, and a wall stands beside it.
class KeepingScene : public testing::Test {
 protected:
  static std::string row() {
    std::string text = box("WALL", "1 1 1", "0 50 0"), balls;
    for (std::size_t i = 0; i < kBalls; ++i) {
      const std::string name = "B" + std::to_string(i);
      text += box(name, "1 1 1", std::to_string(2 * i) + " 0 0", kBounces) + interest(name, "\"WALL\"");
    }
    return text;
  }
  KeepingScene() {
    for (const std::uint32_t id : {3u, 9u}) add_member(p.members, id);
    p.replica.begin(sim(0s));
    p.scene.restart(sim(0s));
    for (const auto& [object, each] : p.scene.all()) p.replica.declare_remote(object, Role::kPredicted);
    advance(10s);
  }
  void advance(Duration t) {
    p.ticks.set_last(p.ticks.number_at(sim(t)));
    p.replica.truth().advance(sim(t));
    p.replica.ghosts().advance(sim(t));
    keeper.maintain(sim(t));
  }
  [[nodiscard]] UpdateRecord record(Duration decision, std::uint32_t sequence, double x) const {
    return {ball, sequence, sim(9s), moving({x, 0, 0}), SimTime{decision}, {}};
  }
  std::vector<UpdateRecord> sent() {
    std::vector<UpdateRecord> all;
    for (const auto& [region, m] : drain_messages(p.outbox, sim(10s))) {
      EXPECT_EQ(region, kWholeScene);
      all.insert(all.end(), m.scene.states.begin(), m.scene.states.end());
    }
    return all;
  }
  [[nodiscard]] double x() const { return p.replica.truth(ball, sim(10s)).position.x(); }
  // A hello of that member whose digest differs from this peer's.
  void differs(std::uint32_t id, std::uint64_t digest = 1) {
    Hello hello;
    hello.session_tx = sim(10s);
    hello.scene_digest = digest;
    keeper.on_digest(*p.members.find(PeerId{id}), hello);
  }

  World world{row()};
  ObjectId ball = world["B0"];
  PeerParts p{config(5), *world.model};
  SceneKeeper keeper{p};
};

TEST_F(KeepingScene, LetsGoOfWhatRestsASecondAfterTheDecision) {
  p.give_scene_object(ball, PeerId{5}, sim(9500ms));
  EXPECT_EQ(p.owners.of(ball), PeerId{5});
  EXPECT_TRUE(p.own.at(ball).adopted);
  advance(10s + 400ms);
  EXPECT_EQ(p.owners.of(ball), PeerId{5});
  p.replica.truth().set_base(ball, sim(10s + 400ms), moving({0, 0, 0}, {1, 0, 0}));
  advance(12s);
  EXPECT_EQ(p.owners.of(ball), PeerId{5}) << "it moves";
  p.replica.truth().set_base(ball, sim(12s), moving({3, 0, 0}));
  advance(12s + 17ms);
  EXPECT_EQ(p.owners.of(ball), kNobody);
  EXPECT_FALSE(p.own.contains(ball));
  EXPECT_EQ(p.replica.ghost(ball, sim(13s)).position, Vec3(3, 0, 0));
  const auto states = sent();
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states[0].decision, sim(9500ms));
  EXPECT_EQ(states[0].sequence, 2u);
}

TEST_F(KeepingScene, ItsNumbersGoOnWhenItIsThisPeersAgain) {
  p.give_scene_object(ball, PeerId{5}, sim(9s));
  p.own.at(ball).sequence = 7;
  p.give_scene_object(ball, PeerId{9}, sim(9200ms));
  EXPECT_FALSE(p.own.contains(ball));
  p.give_scene_object(ball, PeerId{5}, sim(9400ms));
  EXPECT_EQ(p.own.at(ball).sequence, 7u);
}

TEST_F(KeepingScene, AnUpdateOfALaterDecisionNamesTheOwner) {
  EXPECT_TRUE(keeper.take_over(PeerId{9}, record(5s, 1, 0)));
  EXPECT_EQ(p.owners.of(ball), PeerId{9});
  EXPECT_FALSE(keeper.take_over(PeerId{3}, record(4s, 1, 0)));
  EXPECT_FALSE(keeper.take_over(PeerId{3}, record(5s, 1, 0)));
  EXPECT_TRUE(keeper.take_over(PeerId{9}, record(4s, 2, 0))) << "its owner's own";
  EXPECT_TRUE(keeper.take_over(PeerId{3}, record(6s, 1, 0)));
  EXPECT_EQ(p.owners.of(ball), PeerId{3});
}

TEST_F(KeepingScene, AnOwnerThatWasOnlySilentIsItsOwnerAgain) {
  ASSERT_TRUE(keeper.take_over(PeerId{9}, record(5s, 4, 0)));
  keeper.orphan(ball, sim(10s));
  EXPECT_EQ(p.owners.of(ball), kNobody);
  EXPECT_FALSE(keeper.take_over(PeerId{9}, record(5s, 4, 0))) << "that was before";
  EXPECT_TRUE(keeper.take_over(PeerId{9}, record(5s, 5, 0)));
  EXPECT_EQ(p.owners.of(ball), PeerId{9});
  keeper.on_states(PeerId{9}, {sim(0s), {record(5s, 7, 2)}});
  EXPECT_EQ(p.owners.of(ball), kNobody);
  EXPECT_EQ(x(), 2.0);
  EXPECT_FALSE(keeper.take_over(PeerId{9}, record(5s, 6, 0))) << "it has let it go";
}

// Its number may be higher than what this peer knows of its own: that counts the updates of others.
TEST_F(KeepingScene, AnOwnerIsNotTakenForGoneByWhatAnotherPeerSays) {
  p.give_scene_object(ball, PeerId{5}, sim(5s));
  keeper.on_states(PeerId{9}, {sim(0s), {record(5s, 4, 3)}});
  EXPECT_EQ(p.owners.of(ball), PeerId{5});
  EXPECT_TRUE(p.own.contains(ball));
  keeper.on_states(PeerId{9}, {sim(0s), {record(6s, 1, 3)}});
  EXPECT_EQ(p.owners.of(ball), kNobody) << "there was a later decision";
}

// This peer has come from another session, and has shifted the time of the decision by a little more than its owner.
TEST_F(KeepingScene, TheEpochOfALoanIsWhatItsOwnerSays) {
  p.give_scene_object(ball, PeerId{9}, sim(5s + 2ms));
  EXPECT_TRUE(keeper.take_over(PeerId{9}, record(5s, 3, 0)));
  EXPECT_EQ(p.owners.of(ball), PeerId{9});
  EXPECT_EQ(p.scene.decided(ball), sim(5s));
  keeper.on_states(PeerId{3}, {sim(0s), {record(5s, 5, 2)}});
  EXPECT_EQ(p.owners.of(ball), kNobody) << "it has let it go, and peer 3 says so";
  EXPECT_EQ(x(), 2.0);
}

TEST_F(KeepingScene, AnOldUpdateChangesNoEpoch) {
  ASSERT_TRUE(keeper.take_over(PeerId{9}, record(5s, 4, 0)));
  EXPECT_TRUE(keeper.take_over(PeerId{9}, record(4s, 3, 0)));
  EXPECT_EQ(p.scene.decided(ball), sim(5s));
}

// The decision is in force here alone: its author has never owned the ball by it.
TEST_F(KeepingScene, ALoanThatItsOwnerNeverConfirmsIsOver) {
  p.give_scene_object(ball, PeerId{9}, sim(9s));
  advance(20s);
  keeper.offer(host(20s));
  EXPECT_EQ(p.owners.of(ball), PeerId{9});
  EXPECT_FALSE(keeper.take_over(PeerId{3}, record(8s, 9, 0)));
  advance(21s + 10ms);
  keeper.offer(host(21s + 10ms));
  EXPECT_EQ(p.owners.of(ball), kNobody);
  EXPECT_TRUE(keeper.take_over(PeerId{3}, record(8s, 9, 0))) << "whoever knows more counts";
  EXPECT_EQ(p.owners.of(ball), PeerId{3});
}

TEST_F(KeepingScene, ALoanThatItsOwnerConfirmsGoesOn) {
  ASSERT_TRUE(keeper.take_over(PeerId{9}, record(9s, 4, 0)));
  p.replica.note_update(record(9s, 4, 0));
  advance(60s);
  keeper.offer(host(60s));
  EXPECT_EQ(p.owners.of(ball), PeerId{9});
}

TEST_F(KeepingScene, StatesOfWhatIsNoneOfTheSceneAreDropped) {
  UpdateRecord wall = record(5s, 1, 0);
  wall.object = world["WALL"];
  keeper.on_states(PeerId{9}, {sim(0s), {wall}});
  EXPECT_EQ(p.counters.drops["not_scene"], 1u);
}

TEST_F(KeepingScene, NobodyKnowsTheFuture) {
  EXPECT_FALSE(keeper.take_over(PeerId{9}, record(12s, 1, 0)));
  keeper.on_states(PeerId{9}, {sim(0s), {record(12s, 1, 4)}});
  EXPECT_EQ(p.counters.drops["update_time"], 1u);
  EXPECT_EQ(x(), 0.0);
}

TEST_F(KeepingScene, ScenesAreThoseOfThePeerThatHasComputedThemForLonger) {
  keeper.on_states(PeerId{9}, {sim(1s), {record(0s, 1, 4)}});
  EXPECT_EQ(x(), 0.0) << "this peer was here before";
  keeper.on_states(PeerId{9}, {sim(-1s), {record(0s, 1, 4)}});
  EXPECT_EQ(x(), 4.0);
  EXPECT_EQ(p.scene.at(ball).since, sim(-1s));
}

TEST_F(KeepingScene, StatesOfOnePeerCountInAllItsDatagrams) {
  UpdateRecord next = record(0s, 1, 4);
  next.object = world["B1"];
  keeper.on_states(PeerId{9}, {sim(-1s), {record(0s, 1, 4)}});
  keeper.on_states(PeerId{9}, {sim(-1s), {next}});
  EXPECT_EQ(p.replica.truth(ball, sim(10s)).position.x(), 4.0);
  EXPECT_EQ(p.replica.truth(world["B1"], sim(10s)).position.x(), 4.0);
  keeper.on_states(PeerId{3}, {sim(-1s), {record(0s, 1, 7)}});
  EXPECT_EQ(x(), 4.0) << "no longer than peer 9";
}

TEST_F(KeepingScene, TheLowestOfThosePeersThatAgreeSends) {
  keeper.on_states(PeerId{9}, {sim(0s), {record(5s, 1, 4)}});
  differs(9, 0);
  keeper.offer(host(10s));
  EXPECT_TRUE(sent().empty()) << "peer 3 has the same";
  differs(3);
  keeper.offer(host(10s));
  ASSERT_EQ(sent().size(), 1u) << "peer 9 has none";
  keeper.offer(host(10s + 900ms));
  EXPECT_TRUE(sent().empty()) << "not so soon again";
  keeper.offer(host(11s));
  EXPECT_EQ(sent().size(), 1u);
}

TEST_F(KeepingScene, OneOtherDigestMayBeOfWhatIsOnItsWay) {
  keeper.on_states(PeerId{9}, {sim(0s), {record(5s, 1, 4)}});
  differs(3);
  keeper.offer(host(10s));
  EXPECT_TRUE(sent().empty());
  differs(3);
  keeper.offer(host(10s));
  EXPECT_EQ(sent().size(), 1u);
}

TEST_F(KeepingScene, ManyStatesTakeTurns) {
  std::set<ObjectId> named;
  for (std::size_t i = 0; i < kBalls; ++i) {
    UpdateRecord each = record(5s, 1, 0.1);
    each.object = world["B" + std::to_string(i)];
    each.model.state = moving({1.0 / 3.0, 0.7, 0.1});
    keeper.on_states(PeerId{9}, {sim(0s), {each}});
  }
  differs(9, 0);
  differs(3);
  differs(3);
  for (Duration t = 10s; named.size() < kBalls && t < 20s; t += 1s) {
    keeper.offer(host(t));
    const auto states = sent();
    ASSERT_FALSE(states.empty());
    EXPECT_LT(states.size(), kBalls);
    for (const UpdateRecord& u : states) named.insert(u.object);
  }
  EXPECT_EQ(named.size(), kBalls);
}

}  // namespace peerd::replication::scene_keeper_test
