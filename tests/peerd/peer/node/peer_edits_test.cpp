#include "peerd/peer/node/peer_edits.hpp"

#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::peer_edits_test {

using namespace replication;
using namespace std::chrono_literals;
using Kind = config::SceneEdit::Kind;

constexpr PeerId kSelf{1}, kOther{2};
constexpr ObjectId kCar{7};

class Edits : public testing::Test {
 protected:
  OperationId note(Kind kind, std::optional<HostTime> asks_until = {}) {
    const OperationId id{AuthorId{5}, ++number};
    const config::SceneEdit edit{.kind = kind, .path = "CAR"};
    edits.note({edit, id, {}}, kCar, asks_until);
    (void)edits.poll();
    return id;
  }
  void say(const Output& output) { edits.note(output, kSelf); }
  std::string refusal() {
    const auto report = edits.poll();
    return report ? report->refused : "none";
  }
  static HostTime at(Duration t) { return HostTime{t}; }

  std::uint32_t number = 0;
  PeerEdits edits{{}};
};

TEST_F(Edits, ARequestIsAppliedWhenTheObjectIsHere) {
  const OperationId id = note(Kind::kOwn, at(2s));
  say(SceneEdited{id, {}, ""});
  EXPECT_FALSE(edits.find(id)->applied);
  say(ObjectGiven{kCar, kOther, kSelf, {}});
  EXPECT_TRUE(edits.find(id)->applied);
  say(SceneEdited{id, {}, ""});  // its place among all operations is another one now
  EXPECT_TRUE(edits.find(id)->applied);
  EXPECT_EQ(refusal(), "none");
}

TEST_F(Edits, ARequestIsRefusedOnce) {
  const OperationId id = note(Kind::kOwn, at(2s));
  say(SceneEdited{id, {}, "it is not in the scene any more"});
  EXPECT_EQ(refusal(), "it is not in the scene any more");
  edits.give_up(at(3s));
  say(RequestRefused{id, "its owner holds it"});
  EXPECT_EQ(refusal(), "none");
  EXPECT_EQ(edits.find(id)->refused, "it is not in the scene any more");
}

TEST_F(Edits, ARequestThatNobodyAnswersIsGivenUp) {
  const OperationId id = note(Kind::kOwn, at(2s));
  edits.give_up(at(2s) - 1ns);
  EXPECT_EQ(refusal(), "none");
  edits.give_up(at(2s));
  EXPECT_EQ(refusal(), "its owner has not answered");
  EXPECT_EQ(edits.find(id)->refused, "its owner has not answered");
}

TEST_F(Edits, AnAnswerAfterThatCountsNevertheless) {
  const OperationId id = note(Kind::kGrab, at(2s));
  edits.give_up(at(2s));
  EXPECT_FALSE(edits.holds(kCar));
  say(ObjectGiven{kCar, kOther, kSelf, {}});
  EXPECT_TRUE(edits.find(id)->applied);
  EXPECT_EQ(edits.find(id)->refused, "");
  EXPECT_TRUE(edits.holds(kCar));
}

TEST_F(Edits, ARequestEndsWhereTheObjectGoesElsewhere) {
  const OperationId first = note(Kind::kOwn, at(2s));
  say(ObjectGiven{kCar, kOther, PeerId{3}, {}});
  EXPECT_EQ(edits.find(first)->refused, "another peer has it");
  const OperationId second = note(Kind::kGrab, at(2s));
  say(ObjectGiven{kCar, PeerId{3}, kNobody, {}});
  EXPECT_EQ(edits.find(second)->refused, "its owner has released it");
  EXPECT_FALSE(edits.holds(kCar));
}

TEST_F(Edits, AGrabbedObjectIsHeldUntilItIsReleasedOrGone) {
  (void)note(Kind::kOwn);
  EXPECT_FALSE(edits.holds(kCar));
  (void)note(Kind::kGrab);
  say(ObjectGiven{kCar, kNobody, kSelf, {}});
  EXPECT_TRUE(edits.holds(kCar));
  (void)note(Kind::kRelease);
  EXPECT_FALSE(edits.holds(kCar));
  (void)note(Kind::kGrab);
  say(ObjectGiven{kCar, kSelf, kOther, {}});
  EXPECT_FALSE(edits.holds(kCar));
}

TEST_F(Edits, AGrabThatIsRefusedHoldsNothing) {
  const OperationId asked = note(Kind::kGrab, at(2s));
  say(RequestRefused{asked, "its owner holds it"});
  EXPECT_FALSE(edits.holds(kCar));
  const OperationId taken = note(Kind::kGrab);
  say(SceneEdited{taken, {}, "peer 2 owns it by then"});
  EXPECT_FALSE(edits.holds(kCar));
}

TEST_F(Edits, AStoreHasAllUpToAnOperation) {
  const OperationId first = note(Kind::kOwn), second = note(Kind::kRelease), third = note(Kind::kOwn);
  edits.note_stored(second);
  EXPECT_TRUE(edits.find(first)->stored && edits.find(second)->stored);
  EXPECT_FALSE(edits.find(third)->stored);
}

// An operation that is over and not recent is kept in little room, and says the same.
TEST_F(Edits, OldOnesAreStillKnown) {
  const OperationId refused = note(Kind::kGrab, at(2s));
  say(RequestRefused{refused, "its owner holds it"});
  const OperationId plain = note(Kind::kSet);
  say(SceneEdited{plain, {}, ""});
  say(OperationHeld{plain});
  number += 3;  // operations that nobody asked for
  const OperationId late = note(Kind::kSet);
  say(SceneEdited{late, {}, ""});
  const OperationId asks = note(Kind::kOwn, at(9s));
  for (std::size_t i = 0; i < 2 * PeerEdits::kRecentMax; ++i) say(SceneEdited{note(Kind::kSet), {}, ""});
  (void)refusal();
  EXPECT_EQ(edits.find(refused)->refused, "its owner holds it");
  EXPECT_FALSE(edits.find(refused)->applied);
  EXPECT_TRUE(edits.find(plain)->applied && edits.find(plain)->held);
  EXPECT_FALSE(edits.find(plain)->stored);
  EXPECT_FALSE(edits.find({plain.author, plain.number + 1})) << "it is none of this peer's edits";
  EXPECT_TRUE(edits.find(asks)->asks_until) << "a request that goes on is no old one";
  edits.give_up(at(9s));
  EXPECT_EQ(refusal(), "its owner has not answered");
  for (std::size_t i = 0; i < 2; ++i) (void)note(Kind::kSet);
  const OperationId last{plain.author, number};
  edits.note_stored(last);
  EXPECT_TRUE(edits.find(plain)->stored && edits.find(late)->stored && edits.find(last)->stored);
  say(OperationHeld{late});
  say(SceneEdited{late, {}, "it is not in the scene any more"});
  const auto report = must(edits.poll());
  EXPECT_EQ(report.edit.kind, Kind::kSet);
  EXPECT_EQ(report.edit.path, "(operation 5:6)") << "its path is forgotten";
  EXPECT_EQ(report.operation, late);
  EXPECT_EQ(edits.find(late)->refused, "it is not in the scene any more");
  EXPECT_TRUE(edits.find(late)->held);
  say(SceneEdited{late, {}, ""});
  EXPECT_EQ(edits.find(late)->refused, "");
}

}  // namespace peerd::peer_edits_test
