// An operation whose stamp is far ahead, as by a broken clock, waits for its time and holds up nobody else's.
#include <gmock/gmock.h>

#include "tests/replication/peer/editing_peers.hpp"

namespace peerd::replication::peer_far_stamp_test {

using namespace test;
using testing::HasSubstr;
using testing::IsEmpty;

class FarStamp : public EditingPeers {
 protected:
  static constexpr AuthorId kBroken{77};

  // All peers get it, from a member of theirs.
  void give_all(OperationBody body, Duration ahead) {
    Operation operation{{kBroken, ++number_}, lan->session_now(0) + ahead, std::move(body)};
    Message m = message_of(3);
    m.number = 1'000'000 + number_;
    m.incarnation = incarnation_low(100);
    m.operations.push_back({kBroken, written_, encode(operation)});
    written_ += m.operations.back().bytes.size();
    for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(lan->inject(i, encode(m)));
  }

  OperationId last_stored;

 private:
  std::uint32_t number_ = 0;
  std::uint64_t written_ = 0;
};

TEST_F(FarStamp, WaitsForItsTimeAndHoldsUpNobody) {
  begin();
  give_all(RemoveObject{object("CAR")}, 1h);
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lan->peer(i).logs().last(kBroken).number, 1u) << "peer " << i + 1 << " has it";
    EXPECT_TRUE(scene(i).find("CAR"));
  }
  const SimTime before = lan->session_now(0);
  const OperationId id = edit(0, placing("CAR", 5));
  run_on(1s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NE(text_at(i).find("5 0 0"), std::string::npos);
    EXPECT_EQ(lan->seen<SceneEdited>(i).back().operation, id);
  }
  EXPECT_LT(lan->peer(0).logs().last_stamp(id.author), before + 1s) << "no stamp is later because of it";
  EXPECT_EQ(undo(0), "set");
  EXPECT_THAT(lan->peer(0).conflicts().list(lan->session_now(0)), IsEmpty());
}

TEST_F(FarStamp, TakesEffectAtItsTime) {
  begin();
  give_all(placing("CAR", 5), 12s);
  run_on(11s);
  EXPECT_EQ(text_at(1).find("5 0 0"), std::string::npos);
  run_on(2s);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NE(text_at(i).find("5 0 0"), std::string::npos);
}

// A store that had it would put it into the scene at the next start.
TEST_F(FarStamp, GoesToNoStoreBefore) {
  begin();
  const auto stored = [&](std::size_t i) {
    std::uint64_t end = 0;
    for (const LogGrown& each : lan->seen<LogGrown>(i)) {
      if (each.range.author != kBroken) continue;
      EXPECT_EQ(each.range.from, end) << "it goes on where it was";
      end = each.range.to;
      last_stored = each.last;
    }
    return end;
  };
  give_all(placing("BALL", 1), 0s);
  const std::uint64_t first = lan->peer(0).logs().whole(kBroken);
  give_all(placing("CAR", 5), 14s);
  give_all(placing("CAR", 6), 15s);
  run_on(2s);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(stored(i), first);
  EXPECT_EQ(last_stored, (OperationId{kBroken, 1}));
  run_on(4s);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(stored(i), lan->peer(0).logs().whole(kBroken));
  EXPECT_EQ(last_stored, (OperationId{kBroken, 3}));
}

TEST_F(FarStamp, IsWithheldBehindOneThatIsDue) {
  begin();
  give_all(placing("CAR", 5), 14s);
  const std::uint64_t first = lan->peer(0).logs().whole(kBroken);
  give_all(placing("CAR", 6), 1h);
  run_on(6s);
  for (std::size_t i = 0; i < 2; ++i) {
    std::uint64_t end = 0;
    for (const LogGrown& each : lan->seen<LogGrown>(i)) {
      if (each.range.author == kBroken) end = each.range.to;
    }
    EXPECT_EQ(end, first) << "at peer " << i + 1;
  }
}

// An edit that is refused is checked against the scene of then; later ones against what others have done since.
TEST_F(FarStamp, ARefusedEditLeavesNoOldSceneBehind) {
  begin();
  EXPECT_FALSE(lan->peer(0).edit(lan->host_now(0), RemoveObject{ObjectId{99'999}}));
  run_on(11s);
  (void)edit(1, adding("LATER"));
  run_on(2s);
  ASSERT_TRUE(scene(0).find("LATER"));
  (void)edit(0, placing("LATER", 3));
  run_on(1s);
  EXPECT_NE(text_at(2).find("3 0 0"), std::string::npos);
}

TEST_F(FarStamp, AnOperationHasALimitedSize) {
  begin();
  const auto large = lan->peer(0).edit(
      lan->host_now(0), AddNodes{{}, {}, "#VRML V2.0 utf8\n" + std::string(kOperationMax_bytes, '\n'), 0, 0, {}});
  ASSERT_FALSE(large);
  EXPECT_THAT(large.error(), HasSubstr("an operation may have 1048576"));
  EXPECT_EQ(lan->peer(0).counters().operations, 0u);
}

}  // namespace peerd::replication::peer_far_stamp_test
