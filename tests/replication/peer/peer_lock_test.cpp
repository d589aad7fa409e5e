// Locks among whole peers: what one has locked, others are refused where they make it, and do not change where they
// make it all the same.
#include <gmock/gmock.h>

#include "tests/replication/peer/editing_peers.hpp"

namespace peerd::replication::peer_lock_test {

using namespace test;
using testing::HasSubstr;
using testing::StartsWith;

class Locks : public EditingPeers {
 protected:
  void lock(std::size_t i, const std::string& path, bool unlocks = false) const {
    (void)edit(i, LockObject{object(path), unlocks});
    run_on(1s);
  }
  // A member writes a log that asks nobody, and sends it to all.
  void forge(const std::vector<OperationBody>& bodies) {
    OperationPart part{kHostile, 0, {}};
    std::uint32_t number = 0;
    for (const OperationBody& body : bodies) {
      const auto bytes = encode(Operation{
          {kHostile, ++number}, lan->session_now(0) + std::chrono::milliseconds(100 * static_cast<int>(number)), body});
      part.bytes.insert(part.bytes.end(), bytes.begin(), bytes.end());
    }
    Message m = message_of(3, incarnation_low(100));
    m.number = 1'000'000;
    m.operations = {part};
    for (std::size_t i = 0; i < 2; ++i) (void)lan->inject(i, encode(m));
    run_on(2s);
  }
  static constexpr AuthorId kHostile{77};
};

TEST_F(Locks, OthersAreRefusedAtOnce) {
  begin();
  lock(0, "HOUSE");
  const NodeId wall = node("HOUSE/WALL");
  for (std::size_t i = 0; i < 3; ++i) {
    const auto around = lan->peer(i).lock_around(object("HOUSE/WALL"));
    ASSERT_TRUE(around);
    EXPECT_EQ(around->object, object("HOUSE"));
    EXPECT_THAT(around->by, StartsWith("author "));
    EXPECT_EQ(lan->peer(i).locks().size(), 1u);
  }
  const std::string before = text_at(0), why = "it is locked by " + lan->peer(0).locks().front().by;
  EXPECT_EQ(refusal(1, SetData{wall, "colour", "red"}), why);
  EXPECT_EQ(refusal(2, RemoveObject{object("HOUSE/WALL")}), why);
  EXPECT_EQ(refusal(2, adding("ROOF", object("HOUSE"))), why);
  const auto owned = lan->peer(2).own(lan->host_now(2), object("HOUSE/WALL"));
  EXPECT_EQ(owned ? "" : owned.error(), why);
  run_on(1s);
  EXPECT_EQ(text_at(1), before);
  EXPECT_EQ(refusal(1, placing("CAR", 4)), "") << "it stands elsewhere";
  (void)edit(0, placing("HOUSE/WALL", 3));
  run_on(1s);
  EXPECT_NE(text_at(2).find("3 0 0"), std::string::npos);
  lock(2, "HOUSE", true);
  EXPECT_EQ(refusal(1, SetData{wall, "colour", "red"}), "");
  run_on(1s);
  expect_one_world();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(lan->peer(i).locks().empty());
}

TEST_F(Locks, AMemberWhoAsksNobodyChangesNothing) {
  begin();
  const NodeId wall = node("HOUSE/WALL");
  lock(0, "HOUSE");
  const std::string before = text_at(0);
  forge({SetData{wall, "colour", "red"}, RemoveObject{object("HOUSE")}, MoveObject{object("HOUSE/WALL"), {}, {}},
         LockObject{object("HOUSE/WALL")}, GiveObject{object("HOUSE/WALL"), PeerId{3}, kNobody, {}},
         SetField{node("BALL"), "translation", "8 8 8", 0}});
  const std::string why = "it is locked by " + lan->peer(0).locks().front().by;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NE(text_at(i).find("8 8 8"), std::string::npos) << "it has been heard";
    EXPECT_EQ(scene(i).find("HOUSE/WALL"), object("HOUSE/WALL"));
    EXPECT_EQ(lan->peer(i).data().find(wall, "colour"), nullptr);
    EXPECT_EQ(lan->peer(i).owner(object("HOUSE/WALL")), kNobody);
    std::size_t refused = 0;
    for (const SceneEdited& edited : lan->seen<SceneEdited>(i)) {
      if (edited.operation.author == kHostile && edited.refused == why) ++refused;
    }
    EXPECT_EQ(refused, 5u);
  }
  expect_one_world();
}

TEST_F(Locks, TheOwnerGoesOnMovingIt) {
  begin();
  ASSERT_TRUE(lan->peer(1).own(lan->host_now(1), object("CAR")));
  run_on(1s);
  ASSERT_EQ(lan->peer(2).owner(object("CAR")), PeerId{2});
  lock(0, "CAR");
  EXPECT_TRUE(lan->peer(1).change_velocity(lan->host_now(1), object("CAR"), {1, 0, 0}, true));
  run_on(2s);
  const KinematicState state = lan->peer(2).ghost(object("CAR"), lan->session_now(2) - 10ms);
  EXPECT_GT(state.position.x(), 1.0);
  const auto given = lan->peer(1).give(lan->host_now(1), object("CAR"), kNobody);
  EXPECT_THAT(given ? "" : given.error(), HasSubstr("it is locked by"));
  const auto taken = lan->peer(2).own(lan->host_now(2), object("CAR"), false);
  EXPECT_THAT(taken ? "" : taken.error(), HasSubstr("it is locked by"));
}

TEST_F(Locks, WhoJoinsOrComesBackFindsThem) {
  begin();
  lock(0, "HOUSE");
  run_on(1s);
  PeerConfig with_store = config(5);
  for (const LogLength& log : lan->peer(1).logs().lengths()) {
    with_store.log.parts.push_back({log.author, 0, lan->peer(1).log_bytes({log.author, 0, log.bytes})});
  }
  const std::size_t joined = lan->add(config(4)), back = lan->add(with_store);
  EXPECT_EQ(lan->peer(back).locks().size(), 1u) << "before it has heard of anybody";
  run_on(5s);
  for (const std::size_t i : {joined, back}) {
    EXPECT_EQ(lan->peer(i).locks().size(), 1u);
    EXPECT_THAT(refusal(i, placing("HOUSE/WALL", 5)), HasSubstr("it is locked by"));
  }
  expect_one_world();
}

// Where it stands, who has locked it says; the peer of the lowest id may not.
TEST_F(Locks, WhatIsLeftBehindInThemHasItsPlaceByTheirWriter) {
  begin();
  ASSERT_TRUE(lan->peer(2).own(lan->host_now(2), object("CAR")));
  run_on(1s);
  lock(1, "CAR");
  EXPECT_TRUE(lan->peer(2).change_velocity(lan->host_now(2), object("CAR"), {1, 0, 0}, true));
  run_on(2s);
  lan->kill(2);
  run_on(6s);
  const ObjectId car = object("CAR");
  const auto place = [&](std::size_t i) { return lan->peer(i).ghost(car, lan->session_now(i) - 10ms).position; };
  EXPECT_EQ(place(0), place(1));
  EXPECT_GT(place(0).x(), 1.0);
  EXPECT_EQ(text_at(0), text_at(1));
  EXPECT_EQ(lan->drops(0, "place_object") + lan->drops(1, "place_object"), 0u);
}

}  // namespace peerd::replication::peer_lock_test
