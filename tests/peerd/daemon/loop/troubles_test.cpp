#include "peerd/daemon/loop/troubles.hpp"

#include <gmock/gmock.h>

namespace peerd::troubles_test {

using namespace std::chrono_literals;
using replication::Membership;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

HostTime at(Duration t) { return HostTime{t}; }

// A member whose first datagram came at 0, and that has said hello.
replication::Member& heard(Membership& members) {
  (void)members.on_datagram(at(0s), PeerId{7}, 1);
  replication::Member& member = *members.find(PeerId{7});
  member.name = "b";
  member.hello = 1;
  return member;
}

// It is asked four times a second, as a peer asks it.
class FoundLinks : public testing::Test {
 protected:
  std::vector<std::string> found_until(Duration end, const Membership& members) {
    std::vector<std::string> found;
    for (; asked <= at(end); asked += 250ms) found = links.find(members, asked);
    return found;
  }
  OneWayLinks links;
  HostTime asked = at(0s);
};

TEST_F(FoundLinks, AMemberThatDoesNotNameThisPeerForSecondsHearsNothing) {
  Membership members(5s);
  replication::Member& member = heard(members);
  member.echo.on_hello_without_echo(true, 1);
  EXPECT_THAT(found_until(1750ms - 1ns, members), IsEmpty()) << "it is new";
  EXPECT_THAT(found_until(2s, members), ElementsAre(HasSubstr("hears peer b (id 7), which hears nothing")));
  (void)member.echo.on_echo({});
  EXPECT_THAT(found_until(3s, members), IsEmpty());
  member.echo.on_hello_without_echo(true, 1);
  member.echo.echoes_us = false;
  EXPECT_THAT(found_until(4s, members), IsEmpty()) << "it has just lost this one";
  EXPECT_THAT(found_until(6s, members), SizeIs(1));
}

// The others have lost this peer meanwhile, as the hellos say that the kernel has kept.
TEST_F(FoundLinks, AfterAStopOthersHaveTheTimeToHearThisPeerOnceMore) {
  Membership members(5s);
  replication::Member& member = heard(members);
  (void)member.echo.on_echo({});
  EXPECT_THAT(found_until(2s, members), IsEmpty());
  member.echo.echoes_us = false;
  member.echo.on_hello_without_echo(true, 1);
  EXPECT_THAT(found_until(3s, members), IsEmpty());
  asked = at(20s);
  EXPECT_THAT(found_until(21s, members), IsEmpty()) << "of before the stop";
  EXPECT_THAT(found_until(22s, members), SizeIs(1)) << "it still does not";
}

TEST_F(FoundLinks, OneThatHasSaidNoHelloYetSaysNothingOfIt) {
  Membership members(5s);
  heard(members).hello = 0;
  EXPECT_THAT(found_until(4s, members), IsEmpty());
}

TEST(OneWayLink, APeerThatTheSealDoesNotLetInIsNamedByItsNumber) {
  EXPECT_THAT(one_way_link(PeerId{7}), HasSubstr("hears the peer of id 7, which hears nothing of this one"));
}

TEST(EditsAhead, AreATroubleFromWhereTheyWaitForTheirTime) {
  EXPECT_EQ(edits_ahead(-1h), "");
  EXPECT_EQ(edits_ahead(10s), "") << "clocks may differ by that";
  EXPECT_THAT(edits_ahead(10s + 1ns), HasSubstr("ahead of the session's time"));
}

TEST(SaidTroubles, AreSaidOnceAMinuteWhileTheyLast) {
  SaidTroubles said;
  EXPECT_THAT(said.due(at(0s), {"a"}), ElementsAre("a"));
  EXPECT_THAT(said.due(at(1s), {"a", "b"}), ElementsAre("b"));
  EXPECT_THAT(said.due(at(59s), {"a", "b"}), IsEmpty());
  EXPECT_THAT(said.due(at(60s), {"a", "b"}), ElementsAre("a"));
  EXPECT_THAT(said.due(at(70s), {"b"}), ElementsAre("b"));
  EXPECT_THAT(said.due(at(71s), {"a", "b"}), ElementsAre("a")) << "it has begun again";
}

TEST(SaidTroubles, WhatOthersHaveSaidWaitsForAMinute) {
  SaidTroubles said;
  said.note(at(0s), "a");
  EXPECT_THAT(said.due(at(1s), {"a"}), IsEmpty());
  EXPECT_THAT(said.due(at(61s), {"a"}), ElementsAre("a"));
}

}  // namespace peerd::troubles_test
