// Undo and redo by whole peers: what an operation changed is as before, and no more.
#include "tests/replication/peer/editing_peers.hpp"

namespace peerd::replication::peer_undo_test {

using namespace test;

class Undo : public EditingPeers {};

TEST_F(Undo, AFieldIsAsBefore) {
  begin();
  const std::string before = text_at(0);
  (void)edit(1, placing("CAR", 5));
  (void)edit(1, placing("CAR", 7));
  run_on(1s);
  const std::string after = text_at(0);
  EXPECT_EQ(undo(1), "set");
  EXPECT_NE(text_at(0).find("5 0 0"), std::string::npos);
  expect_one_world();
  EXPECT_EQ(undo(1), "set");
  EXPECT_EQ(text_at(2), before);
  expect_one_world();
  EXPECT_EQ(undo(1), "this peer has no edit to undo");
  EXPECT_EQ(redo(1), "set");
  EXPECT_EQ(redo(1), "set");
  EXPECT_EQ(text_at(2), after);
  EXPECT_EQ(redo(1), "this peer has undone nothing since its last edit");
  expect_one_world();
}

TEST_F(Undo, WhatOthersHaveSetSinceStays) {
  begin();
  (void)edit(0, placing("BALL", 3));
  (void)edit(0, placing("CAR", 5));
  run_on(1s);
  (void)edit(1, placing("CAR", 6));
  run_on(1s);
  EXPECT_EQ(undo(0), "set") << "that of the ball: the other one is passed over";
  EXPECT_EQ(text_at(2).find("3 0 0"), std::string::npos);
  EXPECT_NE(text_at(2).find("6 0 0"), std::string::npos);
  EXPECT_EQ(undo(0), "others have changed since what it had changed");
  EXPECT_EQ(undo(1), "set");
  EXPECT_NE(text_at(2).find("5 0 0"), std::string::npos) << "what was there before";
  EXPECT_EQ(undo(0), "set") << "now it counts again";
  expect_one_world();
}

TEST_F(Undo, WhatWasRemovedIsThereAsItWas) {
  begin();
  const ObjectId wall = object("HOUSE/WALL");
  const NodeId wall_node = node("HOUSE/WALL");
  (void)edit(2, SetData{wall_node, "colour", "red"});
  (void)edit(2, AddNodes{{},
                         {},
                         "#VRML V2.0 utf8\nCollisionInterest { objectPath \"BALL\" interests [ \"HOUSE/WALL\" ] }\n",
                         0,
                         0,
                         {}});
  run_on(1s);
  const std::string before = text_at(0);
  (void)edit(1, RemoveObject{object("HOUSE")});
  run_on(1s);
  EXPECT_TRUE(scene().interests.empty());
  EXPECT_EQ(undo(1), "remove");
  EXPECT_EQ(text_at(0), before);
  EXPECT_EQ(scene(2).find("HOUSE/WALL"), wall);
  EXPECT_EQ(node("HOUSE/WALL"), wall_node);
  EXPECT_EQ(*lan->peer(0).data().find(wall_node, "colour"), "red");
  expect_one_world();
  EXPECT_EQ(redo(1), "remove");
  EXPECT_FALSE(scene(0).find("HOUSE"));
  expect_one_world();
  run_on(2s);  // and nobody stumbles
}

TEST_F(Undo, WhatWasAddedIsGoneAndWhatOthersMovedThereIsNot) {
  begin();
  (void)edit(0, adding("BOX"));
  run_on(1s);
  const ObjectId box = object("BOX");
  const std::string before = text_at(0);
  (void)edit(1, MoveObject{object("CAR"), box, {}});
  run_on(1s);
  EXPECT_TRUE(scene().find("BOX/CAR"));
  EXPECT_EQ(undo(0), "add");
  EXPECT_FALSE(scene().find("BOX"));
  EXPECT_TRUE(scene().find("CAR")) << "where it was";
  expect_one_world();
  EXPECT_EQ(redo(0), "add");
  EXPECT_EQ(scene().find("BOX"), box) << "the same again";
  EXPECT_TRUE(scene().find("BOX/CAR"));
  expect_one_world();
  (void)edit(0, adding("NEXT"));
  run_on(1s);
  EXPECT_GT(object("NEXT").number, box.number) << "ids of what was undone are not used again";
}

TEST_F(Undo, AMoveGoesBackWhereThatIsStillThere) {
  begin();
  (void)edit(0, adding("BOX"));
  run_on(1s);
  const ObjectId wall = object("HOUSE/WALL");
  (void)edit(1, MoveObject{wall, object("BOX"), {}});
  run_on(1s);
  EXPECT_EQ(undo(1), "move");
  EXPECT_EQ(scene().find("HOUSE/WALL"), wall);
  EXPECT_EQ(redo(1), "move");
  EXPECT_EQ(scene().find("BOX/WALL"), wall);
  (void)edit(2, RemoveObject{object("HOUSE")});
  run_on(1s);
  EXPECT_EQ(undo(1), "where it stood is not in the scene any more");
  EXPECT_EQ(scene().find("BOX/WALL"), wall);
  expect_one_world();
}

TEST_F(Undo, AnEditEndsRedo) {
  begin();
  (void)edit(0, placing("CAR", 5));
  EXPECT_EQ(undo(0), "set");
  (void)edit(0, placing("BALL", 6));
  run_on(1s);
  EXPECT_EQ(redo(0), "this peer has undone nothing since its last edit");
  EXPECT_EQ(undo(0), "set");
  EXPECT_EQ(text_at(0).find("6 0 0"), std::string::npos);
}

// A peer that joins has only the log.
TEST_F(Undo, WhoComesLaterHasTheSame) {
  begin();
  (void)edit(0, adding("BOX"));
  (void)edit(1, RemoveObject{object("HOUSE")});
  run_on(1s);
  (void)edit(2, placing("BOX", 8));
  (void)edit(2, SetData{node("CAR"), "colour", "red"});
  run_on(1s);
  EXPECT_EQ(undo(1), "remove");
  EXPECT_EQ(undo(0), "add");
  EXPECT_EQ(redo(0), "add");
  lan->add(config(4));
  run_on(4s);
  expect_one_world();
  EXPECT_TRUE(scene(3).find("HOUSE/WALL"));
  EXPECT_NE(text_at(3).find("8 0 0"), std::string::npos);
  EXPECT_EQ(*lan->peer(3).data().find(node("CAR"), "colour"), "red");
}

// Edits, undos and redos of all, on a bad link that is parted now and then.
TEST_F(Undo, AllHaveOneWorldWhateverGetsLost) {
  std::size_t undone = 0, redone = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&](std::uint64_t n) { return random() % n; };
    begin({.latency = 30ms, .jitter = 40ms, .loss = 0.05 * static_cast<double>(draw(6)), .duplicates = 0.05}, seed);
    for (int k = 0; k < 30; ++k) {
      run_on(std::chrono::milliseconds(draw(300)));
      if (draw(8) == 0) lan->part(draw(2) == 0 ? std::set<std::size_t>{} : std::set<std::size_t>{draw(3)});
      const std::size_t i = draw(3);
      const peerd::Scene& here = scene(i);
      const auto any = [&] { return here.id_of(static_cast<std::uint32_t>(draw(here.instances.size()))); };
      if (draw(3) == 0) {
        const bool redoes = draw(2) == 0;
        const auto done = lan->peer(i).undo(lan->host_now(i), redoes);
        if (done) ++(redoes ? redone : undone);
        continue;
      }
      if (here.instances.empty()) continue;
      OperationBody body = adding("N" + std::to_string(k));
      if (draw(4) == 0) body = RemoveObject{any()};
      if (draw(3) == 0) body = MoveObject{any(), any(), {}};
      if (draw(3) == 0) {
        body = SetField{here.document->ids.id_of(here.at(any()).node), "translation", std::to_string(k) + " 0 0", 0};
      }
      (void)lan->peer(i).edit(lan->host_now(i), std::move(body));
    }
    lan->part({});
    run_on(12s);
    expect_one_world();
    if (HasFailure()) FAIL() << "seed " << seed;
  }
  EXPECT_GT(undone, 20u);
  EXPECT_GT(redone, 3u);
}

}  // namespace peerd::replication::peer_undo_test
