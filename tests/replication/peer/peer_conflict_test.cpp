// Which edits are lost by others that did not know them: whole peers list them alike, and nothing else.
#include <gmock/gmock.h>

#include "tests/replication/peer/editing_peers.hpp"

namespace peerd::replication::peer_conflict_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

class ListedConflicts : public EditingPeers {
 protected:
  using Winner = std::optional<OperationId>;
  // The conflicts by loser and winner.
  [[nodiscard]] std::vector<std::pair<OperationId, Winner>> conflicts(std::size_t i, Duration later = 0s) const {
    std::vector<std::pair<OperationId, Winner>> all;
    for (const Conflict& each : lan->peer(i).conflicts().list(lan->session_now(i) + later)) {
      all.emplace_back(each.loser.second, each.winner ? Winner(each.winner->second) : Winner());
    }
    return all;
  }
};

TEST_F(ListedConflicts, NoneWhereOneKnewTheOther) {
  begin();
  (void)edit(0, placing("CAR", 1));
  run_on(1s);
  (void)edit(1, placing("CAR", 2));
  (void)edit(1, SetData{node("CAR"), "seat", "b"});
  run_on(1s);
  (void)edit(2, SetData{node("CAR"), "seat", "c"});
  (void)edit(2, MoveObject{object("CAR"), object("HOUSE"), {}});
  run_on(1s);
  (void)edit(0, RemoveObject{object("HOUSE")});
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(conflicts(i), IsEmpty());
}

TEST_F(ListedConflicts, TheEarlierOfTwoValues) {
  begin();
  const OperationId a = edit(0, placing("CAR", 1));
  const OperationId b = edit(1, placing("CAR", 2));  // within the latency
  run_on(1s);
  const bool b_counts = text_at(0).find("2 0 0") != std::string::npos;
  const auto expected = Pair(b_counts ? a : b, Winner(b_counts ? b : a));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(conflicts(i), ElementsAre(expected)) << "peer " << i + 1;
  (void)edit(2, placing("CAR", 3));  // who knows both
  run_on(1s);
  EXPECT_THAT(conflicts(0), ElementsAre(expected)) << "it stays";
  EXPECT_THAT(conflicts(0, 23h), ElementsAre(expected));
  EXPECT_THAT(conflicts(0, 25h), IsEmpty());
}

// Each side writes on; only the last value of one of them is lost, and not each that its own author has replaced.
TEST_F(ListedConflicts, OnlyTheLastOfEachSide) {
  begin_apart();
  OperationId last_a, last_c;
  for (int k = 0; k < 5; ++k) {
    last_c = edit(2, SetData{node("CAR"), "seat", "c" + std::to_string(k)});
    run_on(200ms);
    last_a = edit(0, SetData{node("CAR"), "seat", "a" + std::to_string(k)});
    run_on(200ms);
  }
  meet();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(conflicts(i), ElementsAre(Pair(last_c, Winner(last_a))));
  EXPECT_EQ(*lan->peer(1).data().find(node("CAR"), "seat"), "a4");
}

TEST_F(ListedConflicts, EditsOfWhatAnotherHasRemoved) {
  begin_apart();
  const OperationId before = edit(2, placing("HOUSE/WALL", 1, 2));
  const OperationId added = edit(2, adding("LAMP", scene(2).find("HOUSE")));
  run_on(1s);
  const OperationId removal = edit(0, RemoveObject{object("HOUSE")});
  run_on(1s);
  const OperationId after = edit(2, SetData{node("HOUSE/WALL", 2), "colour", "red"});
  const OperationId elsewhere = edit(2, placing("CAR", 5));
  run_on(1s);
  meet();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(conflicts(i), UnorderedElementsAre(Pair(before, Winner(removal)), Pair(added, Winner(removal)),
                                                   Pair(after, Winner(removal))))
        << "peer " << i + 1 << ", and not " << elsewhere.number;
  }
}

TEST_F(ListedConflicts, PlacesInTheTree) {
  begin_apart();
  const OperationId into_house = edit(2, MoveObject{object("CAR"), object("HOUSE"), {}});
  run_on(200ms);
  const OperationId into_ball = edit(0, MoveObject{object("CAR"), object("BALL"), {}});
  run_on(200ms);
  const OperationId wall = edit(0, MoveObject{object("HOUSE"), object("BALL"), {}});
  run_on(200ms);
  const OperationId ball = edit(2, MoveObject{object("BALL"), *scene(2).find("HOUSE"), {}});
  run_on(1s);
  meet();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(conflicts(i), UnorderedElementsAre(Pair(into_house, Winner(into_ball)), Pair(ball, Winner(wall))));
  }
}

TEST_F(ListedConflicts, WhatIsUndoneHasWonNothing) {
  begin_apart();
  const OperationId c = edit(2, placing("CAR", 1));
  run_on(200ms);
  const OperationId a = edit(0, placing("CAR", 2));
  run_on(1s);
  meet();
  EXPECT_THAT(conflicts(1), ElementsAre(Pair(c, Winner(a))));
  EXPECT_EQ(undo(0), "set");
  EXPECT_NE(text_at(1).find("1 0 0"), std::string::npos) << "it counts after all";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(conflicts(i), IsEmpty());
}

// What is used at another place, too, is not removed with the one.
TEST_F(ListedConflicts, NoneWhereANodeIsStillUsed) {
  begin();
  (void)edit(0, AddNodes{{},
                         {},
                         "#VRML V2.0 utf8\nDEF ONE Transform { children DEF INNER Transform { } }\n"
                         "DEF TWO Transform { children USE INNER }\n",
                         0,
                         0,
                         {}});
  run_on(1s);
  lan->part({2});
  run_on(3s);
  (void)edit(0, RemoveObject{object("ONE")});
  (void)edit(2, placing("TWO/INNER", 4, 2));
  run_on(1s);
  meet();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(conflicts(i), IsEmpty());
  EXPECT_NE(text_at(0).find("4 0 0"), std::string::npos);
}

}  // namespace peerd::replication::peer_conflict_test
