#include "peerd/peer/node/describe.hpp"

#include <gtest/gtest.h>

#include "core/scene/reader.hpp"

namespace peerd::describe_test {

using namespace replication;
using namespace std::chrono_literals;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF B Transform { children Shape { geometry Box { } } }
)";

struct Describe : testing::Test {
  // "LEVEL TEXT", or "none".
  std::string line(const Output& output) const {
    const auto described = describe(output, scene);
    return described ? std::to_string(static_cast<int>(described->level)) + " " + described->text : "none";
  }
  [[nodiscard]] Output contact(ContactKind kind) const {
    const ContactEvent event{.at = SimTime{1s}, .collider = a, .collidee = b};
    return ContactSeen{kind, event, SimTime{1s + 2500us}};
  }

  Scene scene = read_world(kWorld).scene.value();
  ObjectId a = *scene.find("A"), b = *scene.find("B");
};

TEST_F(Describe, DatagramsAndRetractedContactsHaveNoLine) {
  EXPECT_EQ(line(Send{}), "none");
  EXPECT_EQ(line(ContactsRetracted{}), "none");
}

TEST_F(Describe, AMemberThatMeetsALimitIsNamed) {
  EXPECT_EQ(line(LimitMet{PeerId{7}, MemberLimit::kClockAhead, 3}),
            "2 peer 7 says a time that is farther from this computer's than replication.clock_ahead_s allows: 3 times "
            "(dropped_clock_ahead)");
  EXPECT_EQ(line(LimitMet{PeerId{7}, MemberLimit::kDecisions, 1}),
            "2 peer 7 sends more decisions than one peer is allowed: 1 times (dropped_decision_rate)");
}

TEST_F(Describe, DetailsAreForDebugging) {
  EXPECT_EQ(line(Join{RegionId{7}}), "0 joined region 7");
  EXPECT_EQ(line(Leave{RegionId{7}}), "0 left region 7");
  EXPECT_EQ(line(contact(ContactKind::kPredicted)), "0 A is predicted to hit B, 2.5 ms ago");
  EXPECT_EQ(line(Published{SimTime{}, a, 30, 0.5, PublishReason::kFirst}), "0 update of A: first, threshold 0.5 m");
}

TEST_F(Describe, ChangesOfTheSessionAreInformation) {
  EXPECT_EQ(line(Synchronised{PeerId{2}, 1500us, 250us}),
            "1 in session: follows the clock of peer 2, offset 1.500 ms, error at most 0.250 ms");
  EXPECT_EQ(line(PeerJoined{PeerId{2}, "b", false}), "1 peer b (id 2) joined");
  EXPECT_EQ(line(PeerJoined{PeerId{2}, "b", true}), "1 peer b (id 2) restarted");
  EXPECT_EQ(line(PeerLost{PeerId{2}, "b", true}), "1 peer b (id 2) left");
  EXPECT_EQ(line(Overruled{a, b, SimTime{}}), "1 A on B: another peer's decision counts");
  EXPECT_EQ(line(contact(ContactKind::kOwner)), "1 A hit B, 2.5 ms ago");
  EXPECT_EQ(line(contact(ContactKind::kDecided)), "1 A hit (decided here) B, 2.5 ms ago");
  EXPECT_EQ(line(contact(ContactKind::kApplied)), "1 A hit (decided there) B, 2.5 ms ago");
}

TEST_F(Describe, AContactSaysWhichPolygonsTouch) {
  Output output = contact(ContactKind::kOwner);
  auto& event = std::get<ContactSeen>(output).contact;
  event.type = CollisionType::kWitness;
  event.polygons = {1, {{{a, 3}, {b, 1}}}};
  EXPECT_EQ(line(output), "1 A hit B, 2.5 ms ago: A polygon 3 - B polygon 1 (witness)");
  event.type = CollisionType::kAllPairs;
  event.polygons.count = 70;
  EXPECT_EQ(line(output), "1 A hit B, 2.5 ms ago: A polygon 3 - B polygon 1 and 69 more (allpairs)");
}

TEST(DescribeMissing, SaysForWhomAPeerWaitsAndWhenItWaitsNoMore) {
  const std::vector<AwaitedPeer> missing{{PeerId{2}, "b"}, {PeerId{3}, "c"}};
  EXPECT_EQ(describe_missing(missing).text, "waits for peer b (id 2), peer c (id 3): nothing moves before");
  EXPECT_EQ(describe_missing({}).text, "all peers are here, and motions begin");
}

TEST_F(Describe, ABoundedLatencySaysItsDelayAndWhatWasTooLateForIt) {
  EXPECT_EQ(line(DelayShown{140ms}), "1 shows all as it was 140 ms ago, own objects too");
  EXPECT_EQ(line(CameTooLate{3, 2, 1, 12500us}),
            "2 came too late to be shown in time: 3 updates and 1 decisions, by up to 12.5 ms; 2 updates never came");
}

TEST_F(Describe, TroublesOfTheWorldAreWarnings) {
  EXPECT_EQ(line(IdInUse{PeerId{1}, false, false}),
            "2 two programs are peer 1; what the one says that started earlier is dropped");
  EXPECT_EQ(line(NameInUse{PeerId{2}, PeerId{1}, "b"}), "2 peers 1 and 2 have one name, b; give each peer its own");
  EXPECT_EQ(line(PeerLost{PeerId{2}, "b", false}), "2 peer b (id 2) is lost: it has gone silent");
  EXPECT_EQ(line(ObjectOrphaned{a, PeerId{2}}), "2 A stands still: its owner, peer 2, is gone");
  EXPECT_EQ(line(ClockStepped{2ms, 1ms, true}),
            "1 back in the session: the session clock stepped forward by 1.000 ms, offset 2.000 ms");
  EXPECT_EQ(line(ClockStepped{2ms, 1ms, false}),
            "2 two sessions have met: the session clock stepped forward by 1.000 ms, offset 2.000 ms");
  EXPECT_EQ(line(BodiesOverlap{SimTime{}, a, b}), "2 A and B overlap from the start");
  EXPECT_EQ(line(HostSuspended{4500ms}), "2 this peer was stopped for 4.5 s; its objects go on from where they were");
}

TEST_F(Describe, WhatAPersonMustMendAreErrors) {
  EXPECT_EQ(line(IdInUse{PeerId{1}, true, false}),
            "3 another program goes on as peer 1; end it, or give each peer an id of its own");
  EXPECT_EQ(line(IdInUse{PeerId{1}, true, true}), "3 another program has taken over as peer 1");
  EXPECT_EQ(line(OwnershipConflict{b, PeerId{1}}), "3 two peers own B; peer 1 keeps it");
}

TEST_F(Describe, AFounderThatGivesWayIsNoMistake) {
  EXPECT_EQ(line(FounderGaveWay{b, PeerId{1}, PeerId{7}}),
            "1 B, which the world's file gave to peer 1 as the founder, is peer 7's by its settings");
}

TEST_F(Describe, TheSecondSilenceOfAFeedIsForDebugging) {
  using Kind = feed::Notice::Kind;
  const auto notice = [](Kind kind, bool again) {
    const LogLine described = describe(feed::Notice{kind, "CAR", again});
    return std::to_string(static_cast<int>(described.level)) + " " + described.text;
  };
  EXPECT_EQ(notice(Kind::kBegan, false), "1 a program moves CAR");
  EXPECT_EQ(notice(Kind::kSilent, false), "2 CAR stands still: the program that moves it is silent");
  EXPECT_EQ(notice(Kind::kSilent, true), "0 CAR stands still: the program that moves it is silent");
  EXPECT_EQ(notice(Kind::kResumed, false), "1 CAR gets poses again");
  EXPECT_EQ(notice(Kind::kResumed, true), "0 CAR gets poses again");
  EXPECT_EQ(notice(Kind::kRefused, false), "2 a pose of CAR; more such are only counted");
  EXPECT_EQ(notice(Kind::kNotUnderstood, false),
            "2 a datagram that is no message of poses: CAR; more such are only counted");
}

}  // namespace peerd::describe_test
