#include "replication/session/line_of_descent.hpp"

#include <gtest/gtest.h>

namespace peerd::replication {
namespace {

using enum LineMeeting;

TEST(LineOfDescent, TheSameIsTheSame) {
  EXPECT_EQ(meet({7, true, true}, {7, false, false}), kSame);
  EXPECT_EQ(meet({}, {0, true, true}), kSame);
}

TEST(LineOfDescent, OldEditsDoNotComeIntoASessionThatWasBegunAnew) {
  EXPECT_EQ(meet({0, true, false}, {7, false, true}), kGoOver);
  EXPECT_EQ(meet({5, true, false}, {7, true, true}), kGoOver);
  EXPECT_EQ(meet({9, true, false}, {7, true, true}), kGoOver) << "a newcomer resets no session";
}

TEST(LineOfDescent, WhoBeginsAnewJoinsTheSessionThatIsHere) {
  EXPECT_EQ(meet({9, false, false}, {0, true, true}), kTake);
  EXPECT_EQ(meet({9, false, false}, {7, false, true}), kTake);
}

TEST(LineOfDescent, APeerOfTheFileAloneTakesWhatOthersHave) {
  EXPECT_EQ(meet({0, false, true}, {7, true, false}), kTake) << "a session of the file alone loses nothing";
}

TEST(LineOfDescent, TwoSessionsWithEditsStayApart) { EXPECT_EQ(meet({7, true, true}, {9, true, true}), kApart); }

TEST(LineOfDescent, BothComeToResultsThatFit) {
  for (unsigned bits = 0; bits < 1u << 8; ++bits) {
    const auto side = [](unsigned b) {
      return LineOfDescent{(b & 3u) * 5, (b & 4u) != 0, (b & 8u) != 0};  // lines 0, 5, 10, 15
    };
    const LineOfDescent a = side(bits & 15u), b = side(bits >> 4);
    const LineMeeting of_a = meet(a, b), of_b = meet(b, a);
    const auto fits = [](LineMeeting one, LineMeeting other) {
      if (one == kSame || one == kApart) return other == one;
      return (one == kStay) == (other == kTake || other == kGoOver);
    };
    EXPECT_TRUE(fits(of_a, of_b)) << bits;
    EXPECT_NE(of_a == kTake && a.has_edits, true) << bits;
    EXPECT_NE(of_a == kGoOver && !a.has_edits, true) << bits;
    EXPECT_NE(of_a == kGoOver && a.in_session && b.in_session, true) << bits << ": a session is not begun anew";
  }
}

}  // namespace
}  // namespace peerd::replication
