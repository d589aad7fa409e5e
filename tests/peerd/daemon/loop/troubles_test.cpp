#include "peerd/daemon/loop/troubles.hpp"

#include <gmock/gmock.h>

namespace peerd::troubles_test {

using namespace std::chrono_literals;
using replication::Membership;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

HostTime at(Duration t) { return HostTime{t}; }

// A member whose first datagram came at 0, and that has said hello.
replication::Member& heard(Membership& members) {
  (void)members.on_datagram(at(0s), PeerId{7}, 1);
  replication::Member& member = *members.find(PeerId{7});
  member.name = "b";
  member.hello = 1;
  return member;
}

TEST(OneWayLinks, AMemberThatDoesNotNameThisPeerForSecondsHearsNothing) {
  Membership members(5s);
  replication::Member& member = heard(members);
  member.echo.on_hello_without_echo(true, 1);
  EXPECT_THAT(one_way_links(members, at(1s)), IsEmpty()) << "it is new";
  EXPECT_THAT(one_way_links(members, at(2s)), ElementsAre(HasSubstr("hears peer b (id 7), which hears nothing")));
  (void)member.echo.on_echo({});
  EXPECT_THAT(one_way_links(members, at(3s)), IsEmpty());
}

TEST(OneWayLinks, OneThatHasSaidNoHelloYetSaysNothingOfIt) {
  Membership members(5s);
  heard(members).hello = 0;
  EXPECT_THAT(one_way_links(members, at(4s)), IsEmpty());
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
