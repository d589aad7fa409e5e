#include "replication/objects/contacts/contact_decisions.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "replication/peer/peer_parts.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::contact_decisions_test {

using namespace test;

// This peer owns A, peer `other` owns B, and peer 9 owns C.
class Deciding : public testing::Test {
 protected:
  explicit Deciding(std::uint32_t self = 2, std::uint32_t remote = 3, std::string fields = kBounces)
      : fields_of_a(std::move(fields)), other(remote), conf(config(self, {{a}})) {
    owners.set(a, PeerId{self});
    owners.set(b, other);
    owners.set(c, PeerId{9});
    for (const ObjectId object : {a, b, c}) scene.remove(object);
    echo_us(add_member(members, remote), 0.001);
    echo_us(add_member(members, 9), 0.001);
    begin_worlds();
    tick_to(10s);
  }
  void begin_worlds() {
    replica.begin(sim(0s));
    replica.truth().declare(a, Role::kAuthoritative);
    replica.ghosts().declare(a, Role::kPredicted);
    for (const ObjectId object : {b, c}) replica.declare_remote(object, Role::kPredicted);
  }
  // This peer has published that A stands there since then, and knows a decision of that time.
  void publish(double x, SimTime at, SimTime decision) {
    const UpdateRecord update{a, ++own.at(a).sequence, at, moving({x, 0, 0}), decision};
    own.at(a).delivery.record = update;
    replica.ghosts().set_base(a, at, update.model);
    replica.keep_update(update);
  }
  void tick_to(Duration t) { ticks.set_last(ticks.number_at(sim(t))); }
  ContactEvent contact(SimTime at = sim(10s)) const {
    ContactEvent e;
    e.at = at;
    e.collider = a;
    e.collidee = b;
    e.normal = Vec3::UnitX();
    e.collider_before = moving({0, 0, 0}, {-1, 0, 0});
    e.collider_after = moving({0, 0, 0}, {1, 0, 0});
    e.collidee_before = e.collidee_after = moving({-1, 0, 0});
    return e;
  }
  static ContactEvent left_to_another(ContactEvent e) {
    e.deferred = true;
    return e;
  }
  DecisionRecord record(SimTime at = sim(10s)) const {
    const ContactEvent e = contact(at);
    return {e.collider,       e.collidee,        e.at, e.normal, e.collider_before, e.collidee_before, e.collider_after,
            e.collidee_after, DecisionRule::kId, {}};
  }
  // The time is long enough for a deferred contact of 10 s.
  Duration patience() const { return 10s + 2 * members.longest_latency() + 3 * conf.hello_period; }
  std::size_t decided() { return drain<ContactSeen>(outbox).size(); }

  std::string fields_of_a;
  World world{box("A", "1 1 1", "0 0 0", fields_of_a) + box("B", "1 1 1", "-5 0 0") + box("C", "1 1 1", "9 9 9") +
                  interest("A", "\"B\" \"C\"") + interest("B", "\"C\""),
              {"A", "B", "C"}};
  ObjectId a = world["A"], b = world["B"], c = world["C"];
  PeerId other;
  PeerConfig conf;
  PeerCounters counters;
  Membership members{1750ms};
  Owners owners;
  OwnObjects own{*world.in_force, conf.owned, false};
  SceneObjects scene{*world.in_force};
  Replica replica{*world.in_force};
  Display display{conf, *world.in_force, own, replica, counters};
  TickGrid ticks{60};
  Outbox outbox{conf.id, conf.incarnation, counters};
  std::vector<std::pair<ObjectId, PeerId>> adopted;
  ContactDecisions decisions{
      conf,     *world.in_force,
      members,  owners,
      scene,    own,
      replica,  display,
      ticks,    outbox,
      counters, [this](ObjectId object, PeerId author, SimTime) { adopted.emplace_back(object, author); }};
};
// The other peer has the lower id.
class Deferring : public Deciding {
 protected:
  Deferring() : Deciding(3, 2) {}
};
// All peers show the past.
class ShowingThePast : public Deferring {
 protected:
  ShowingThePast() {
    conf.bounded_latency.least = 500ms;
    conf.decisions.policy = DecisionPolicy::kVelocity;
    begin_worlds();
  }
  double x(Duration t) {
    replica.ghosts().advance(sim(12s));  // the past of 6 s is kept
    return replica.ghost(a, sim(t)).position.x();
  }
};

// ---- which contacts this peer looks for ----

TEST_F(Deciding, WhoMayDecideIsOneOfTwoOwnersByThePolicy) {
  const PeerId one{1}, two{2}, three{3};
  for (const DecisionPolicy policy : {DecisionPolicy::kId, DecisionPolicy::kVelocity, DecisionPolicy::kServer}) {
    conf.decisions.policy = policy;
    conf.decisions.server = one;
    EXPECT_TRUE(decisions.may_decide(two, two, three));
    EXPECT_EQ(decisions.may_decide(three, two, three), policy != DecisionPolicy::kId);
    EXPECT_EQ(decisions.may_decide(one, two, three), policy == DecisionPolicy::kServer);
    EXPECT_FALSE(decisions.may_decide(two, two, two)) << "one owner needs no decision";
    EXPECT_FALSE(decisions.may_decide(two, two, kNobody));
    EXPECT_FALSE(decisions.may_decide(two, kNobody, two));
  }
}

TEST_F(Deciding, ByIdTheLowerOneDecides) {
  EXPECT_EQ(decisions.authority(a, b, sim(10s)), ContactAuthority::kLocal);
  EXPECT_EQ(decisions.authority(b, c, sim(10s)), ContactAuthority::kAsPublished) << "others' are predictions";
  EXPECT_STREQ(decisions.on_decision(other, 1, record(), sim(10s)), "not_decider") << "the higher one does not";
  owners.set(b, kNobody);
  EXPECT_EQ(decisions.authority(a, b, sim(10s)), ContactAuthority::kAsPublished) << "the scene decides nothing";
}

TEST_F(Deferring, ByIdTheHigherOneDoesNotEvenLook) {
  EXPECT_EQ(decisions.authority(a, b, sim(10s)), ContactAuthority::kAsPublished);
  conf.decisions.policy = DecisionPolicy::kServer;
  conf.decisions.server = PeerId{9};
  EXPECT_EQ(decisions.authority(a, b, sim(10s)), ContactAuthority::kDeferred) << "the server does";
  conf.decisions.server = PeerId{3};
  EXPECT_EQ(decisions.authority(a, b, sim(10s)), ContactAuthority::kLocal);
  EXPECT_EQ(decisions.authority(b, c, sim(10s)), ContactAuthority::kLocal) << "the server decides others' too";
}

// ARM is peer 3's. The camera sees its hand and B, and not where the arm's origin is.
TEST(DecidingByParts, AnEndIsInViewWhereItsPartsAre) {
  const World world(arm() + box("B", "1 1 1", "21 0 0") + interest("ARM", "\"B\""), {"ARM", "ARM/HAND", "B"});
  PeerConfig conf = config(3, {{world["ARM"]}});
  conf.decisions.policy = DecisionPolicy::kFieldOfView;
  conf.decisions.viewpoint.emplace().pose.position = {20.5, 0, 10};
  PeerParts p{conf, *world.model};
  p.owners.set(world["B"], PeerId{2});
  echo_us(add_member(p.members, 2), 0.001);
  p.replica.begin(sim(0s));
  p.ticks.set_last(p.ticks.number_at(sim(10s)));
  p.replica.ghosts().advance(sim(10s));
  EXPECT_EQ(p.decisions.authority(world["ARM"], world["B"], sim(10s)), ContactAuthority::kLocal);
  p.config.decisions.viewpoint->pose.position = {0, 0, 10};
  EXPECT_EQ(p.decisions.authority(world["ARM"], world["B"], sim(10s)), ContactAuthority::kDeferred);
}

TEST_F(Deciding, NobodyDecidesAContactOfMoreThanThreeSecondsAgo) {
  EXPECT_EQ(decisions.authority(a, b, ticks.last_time() - 3s), ContactAuthority::kLocal);
  EXPECT_EQ(decisions.authority(a, b, ticks.last_time() - 3s - 1ns), ContactAuthority::kDeferred);
  decisions.defer(left_to_another(contact(ticks.last_time() - 3s - 1ns)));
  EXPECT_FALSE(decisions.has_deferred());
  EXPECT_EQ(counters.contacts_too_late, 1u);
}

// ---- contacts that this peer has found ----

TEST_F(Deciding, ADecisionMovesTheGhostsAndIsReportedAndNoted) {
  decisions.decide(contact(), sim(10020ms));
  EXPECT_EQ(replica.ghost(a, sim(11s)).position, Vec3(1, 0, 0));
  const auto seen = drain<ContactSeen>(outbox);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].kind, ContactKind::kDecided);
  EXPECT_EQ(seen[0].known_at, sim(10020ms));
  EXPECT_EQ(counters.decisions, 1u);
  EXPECT_EQ(decisions.log().last(a, b), sim(10s));
  const auto notes = decisions.notes();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_FALSE(notes[0].deferred);
  EXPECT_EQ(notes[0].contact, sim(10s));
  EXPECT_EQ(decisions.entries().at(0).copies, 1) << "on a good link";
}

// Chaos seed 20879: after an update had come late, the world went through the past again, and met the other one at the
// same instant by another face. The others had the first outcome.
TEST_F(Deciding, AContactThatIsFoundOnceMoreWithAnotherOutcomeIsAnotherDecision) {
  decisions.decide(contact(), sim(10020ms));
  decisions.decide(contact(), sim(10030ms));
  EXPECT_EQ(decisions.entries().size(), 1u) << "the same once more";
  ContactEvent again = contact();
  again.normal = Vec3::UnitZ();
  again.collider_after = moving({0, 0, 0}, {0, 0, 5});
  decisions.decide(again, sim(10040ms));
  ASSERT_EQ(decisions.entries().size(), 2u);
  EXPECT_EQ(decisions.entries().back().record.contact, sim(10s) + 1ns);
  EXPECT_EQ(decisions.entries().back().record.collider_after.velocity, Vec3(0, 0, 5)) << "which the others take";
  EXPECT_NEAR(replica.ghost(a, sim(11s) + 1ns).position.z(), 5.0 + 5e-9, 1e-12);
  decisions.decide(again, sim(10050ms));
  EXPECT_EQ(decisions.entries().size(), 2u) << "the same once more";
}

// The second one is a nanosecond later, and its states are of then.
TEST_F(Deciding, TwoAtOneInstantFollowEachOther) {
  ContactEvent with_c = contact();
  with_c.collidee = c;
  with_c.collider_after.acceleration = Vec3(0, 2, 0);
  decisions.decide(contact(), sim(10s));
  decisions.decide(with_c, sim(10s));
  ASSERT_EQ(decisions.log().entries().size(), 2u);
  const DecisionRecord& second = decisions.log().entries()[1].record;
  EXPECT_EQ(second.contact, sim(10s) + Duration{1});
  EXPECT_EQ(second.collider_after, advance(with_c.collider_after, 1e-9));
  EXPECT_EQ(second.collidee_before, advance(with_c.collidee_before, 1e-9));
}

class DecidingWithFriction : public Deciding {
 protected:
  DecidingWithFriction() : Deciding(2, 3, " collisionResponse CollisionResponse { responseType 2 friction 0.3 } ") {}
};
TEST_F(DecidingWithFriction, WhatSlidesGoesOnSlidingANanosecondLater) {
  const CollisionResponse* const response = (*world.in_force)->response_of(a);
  ContactEvent with_c = contact();
  with_c.collidee = c;
  with_c.collider_after = sliding_to_rest(moving({0, 0, 0}, {0.7, 0.1, 0.3}), response->friction_m_s2).state;
  ASSERT_EQ(law_of_outcome(response, with_c.collider_after).kind, MotionKind::kSliding);
  decisions.decide(contact(), sim(10s));
  decisions.decide(with_c, sim(10s));
  ASSERT_EQ(decisions.log().entries().size(), 2u);
  const KinematicState& later = decisions.log().entries()[1].record.collider_after;
  EXPECT_LT(later.velocity.norm(), with_c.collider_after.velocity.norm());
  EXPECT_EQ(law_of_outcome(response, later).kind, MotionKind::kSliding);
}

// B answers no contact.
TEST_F(Deciding, WhatAnswersNothingGoesAsItsOwnerSays) {
  decisions.decide(contact(), sim(10s));
  EXPECT_EQ(decisions.last_binding(a), sim(10s));
  EXPECT_EQ(decisions.last_binding(b), SimTime{});
}
TEST_F(Deferring, WhatAnswersNothingGoesByADecisionOfItsOwner) {
  ASSERT_EQ(decisions.on_decision(other, 1, record(), sim(10s)), nullptr);
  EXPECT_EQ(decisions.last_binding(a), sim(10s));
  EXPECT_EQ(decisions.last_binding(b), sim(10s));
}

TEST_F(Deciding, CopiesAreAsManyAsTheLossAsksFor) {
  echo_us(*members.find(other), 0.5);
  decisions.decide(contact(), sim(10s));
  EXPECT_EQ(decisions.entries().at(0).copies, 3);
}

TEST_F(Deciding, StatesBeyondTheWiresLimitsAreDecidedAtRest) {
  ContactEvent wild = contact();
  wild.collider_after.velocity = {1e13, 0, 0};
  decisions.decide(wild, sim(10s));
  EXPECT_EQ(counters.states_out_of_range, 1u);
  EXPECT_EQ(decisions.entries().at(0).record.collider_after.velocity, Vec3(0, 0, 0));
}

TEST_F(Deferring, ADeferredContactIsNotedAndDecidedByNobodyElseInTime) {
  conf.decisions.policy = DecisionPolicy::kVelocity;
  replica.ghosts().set_base(b, sim(0s), moving({-5, 0, 0}, {0, 9, 0}));  // the faster one decides
  replica.ghosts().advance(sim(10s));
  ContactEvent found = contact();
  found.type = CollisionType::kAllPairs;
  decisions.defer(left_to_another(found));
  EXPECT_EQ(counters.contacts_held, 1u);
  EXPECT_TRUE(decisions.awaits_decision_on(a) && decisions.awaits_decision_on(b));
  EXPECT_FALSE(decisions.awaits_decision_on(c));
  ASSERT_EQ(decisions.notes().size(), 1u);
  EXPECT_TRUE(decisions.notes()[0].deferred);
  decisions.resolve_overdue(sim(patience()) - 1ns);
  EXPECT_TRUE(decisions.has_deferred());
  EXPECT_EQ(decided(), 0u);
  decisions.resolve_overdue(sim(patience()));
  EXPECT_FALSE(decisions.has_deferred());
  EXPECT_EQ(counters.decisions_fallback, 1u);
  const auto seen = drain<ContactSeen>(outbox);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].contact.type, CollisionType::kAllPairs) << "as it was found";
  EXPECT_EQ(seen[0].contact.polygons.count, 21u) << "of five faces with five, all but those of opposite sides";
  EXPECT_EQ(decisions.entries().at(0).record.rule, DecisionRule::kId);
}

TEST_F(ShowingThePast, ADecisionByFallbackIsLate) {
  decisions.defer(left_to_another(contact()));
  decisions.resolve_overdue(sim(patience()) + 1s);
  EXPECT_EQ(counters.decisions_fallback, 1u);
  EXPECT_EQ(counters.decisions_late, 1u) << "nobody could know it within the bound";
}

TEST_F(Deferring, WithoutFallbackNobodyDecides) {
  conf.decisions.fallback = false;
  decisions.defer(left_to_another(contact()));
  decisions.resolve_overdue(sim(patience()));
  EXPECT_FALSE(decisions.has_deferred());
  EXPECT_EQ(counters.decisions, 0u);
}

TEST_F(Deferring, AContactJustBeforeADecidedOneIsTheSame) {
  ASSERT_EQ(decisions.on_decision(other, 1, record(), sim(10s)), nullptr);
  decisions.defer(left_to_another(contact(sim(10s) - DecisionLog::kSameCollision)));
  decisions.defer(left_to_another(contact(sim(10s))));
  EXPECT_FALSE(decisions.has_deferred());
  decisions.defer(left_to_another(contact(sim(10s) + 1ns)));
  EXPECT_TRUE(decisions.has_deferred());
}

// ---- what other peers say ----

TEST_F(Deferring, AnothersDecisionMovesBothWorldsAndEndsTheWaiting) {
  decisions.defer(left_to_another(contact()));
  EXPECT_EQ(decisions.on_decision(other, 1, record(), sim(10100ms)), nullptr);
  EXPECT_FALSE(decisions.has_deferred());
  EXPECT_EQ(replica.truth(a, sim(11s)).position, Vec3(1, 0, 0));
  EXPECT_EQ(replica.ghost(a, sim(11s)).position, Vec3(1, 0, 0));
  std::vector<ContactSeen> seen;
  std::vector<ContactsRetracted> retracted;
  while (const auto out = outbox.poll()) {
    if (const auto* s = std::get_if<ContactSeen>(&*out)) seen.push_back(*s);
    if (const auto* r = std::get_if<ContactsRetracted>(&*out)) retracted.push_back(*r);
  }
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].kind, ContactKind::kApplied);
  EXPECT_EQ(seen[0].contact.at, sim(10s));
  EXPECT_EQ(seen[0].contact.type, CollisionType::kWitness);
  EXPECT_EQ(seen[0].contact.polygons.count, 1u) << "by where the decider had them";
  ASSERT_EQ(retracted.size(), 1u) << "of the own object, not of the other's";
  EXPECT_EQ(retracted[0].object, a);
}

// The owner has published since the later one, and the others go by that.
TEST_F(Deferring, ADecisionOnAnEarlierContactLeavesWhatIsKnownOfLaterTimes) {
  ASSERT_EQ(decisions.on_decision(other, 1, record(sim(10500ms)), sim(10600ms)), nullptr);
  publish(7.0, sim(10600ms), sim(10500ms));
  ASSERT_EQ(decisions.on_decision(other, 2, record(sim(10200ms)), sim(10700ms)), nullptr);
  EXPECT_NEAR(replica.ghost(a, sim(10400ms)).position.x(), 0.2, 1e-9);
  EXPECT_NEAR(replica.ghost(a, sim(10550ms)).position.x(), 0.05, 1e-9);
  EXPECT_EQ(replica.ghost(a, sim(11s)).position.x(), 7.0);
  ASSERT_EQ(decisions.on_decision(other, 3, record(sim(10550ms)), sim(10800ms)), nullptr);
  EXPECT_NEAR(replica.ghost(a, sim(11s)).position.x(), 0.45, 1e-9) << "that update doesn't know of this one";
}

TEST_F(Deciding, AContactFoundLateLeavesWhatIsKnownOfLaterTimes) {
  decisions.decide(contact(sim(10500ms)), sim(10510ms));
  publish(7.0, sim(10600ms), sim(10500ms));
  decisions.decide(contact(sim(10200ms)), sim(10700ms));
  EXPECT_NEAR(replica.ghost(a, sim(10400ms)).position.x(), 0.2, 1e-9);
  EXPECT_NEAR(replica.ghost(a, sim(10550ms)).position.x(), 0.05, 1e-9);
  EXPECT_EQ(replica.ghost(a, sim(11s)).position.x(), 7.0);
}

// The past is shown, so that all updates of it count, and not the last one alone.
TEST_F(ShowingThePast, UpdatesBetweenDecisionsAreLaidAgain) {
  publish(3.0, sim(10100ms), {});
  ASSERT_EQ(decisions.on_decision(other, 1, record(sim(10500ms)), sim(10600ms)), nullptr);
  publish(5.0, sim(10600ms), sim(10500ms));
  publish(7.0, sim(10700ms), sim(10500ms));
  ASSERT_EQ(decisions.on_decision(other, 2, record(sim(10s)), sim(10800ms)), nullptr);
  EXPECT_NEAR(x(10200ms), 0.2, 1e-9) << "the first one does not know of the decision of 10 s";
  EXPECT_NEAR(x(10550ms), 0.05, 1e-9);
  EXPECT_EQ(x(10650ms), 5.0);
  EXPECT_EQ(x(11s), 7.0);
}

// This peer's decision by fallback, and another one by the policy, of a little later, which knows nothing of it.
TEST_F(ShowingThePast, AnOverruledDecisionHasMovedNothing) {
  decisions.defer(left_to_another(contact()));
  decisions.resolve_overdue(sim(patience()) + 1s);
  ASSERT_EQ(counters.decisions_fallback, 1u);
  EXPECT_NEAR(x(10050ms), 0.05, 1e-9);
  DecisionRecord overruling = record(sim(10100ms));
  overruling.rule = DecisionRule::kVelocity;
  ASSERT_EQ(decisions.on_decision(other, 1, overruling, sim(patience()) + 1s), nullptr);
  ASSERT_EQ(counters.decisions_overruled, 1u);
  EXPECT_EQ(x(10050ms), 0.0) << "as at all peers that have never known it";
  EXPECT_NEAR(x(10200ms), 0.1, 1e-9);
}

// Decisions on contacts of an object from before its owner left are void.
TEST_F(Deferring, ALaterLifeIsNotBoundByAnEarlierOne) {
  decisions.end_life_of(b, sim(9s));
  EXPECT_STREQ(decisions.on_decision(other, 1, record(sim(8999ms)), sim(10s)), "decision_before_life");
  EXPECT_EQ(decisions.on_decision(other, 2, record(sim(9s)), sim(10s)), nullptr);
}

// A peer that had not begun when the owner left knows no time of that but its own beginning.
TEST_F(Deciding, ALifeThatEndedBeforeThisPeerBeganBindsNothingFromThenOn) {
  decisions.end_life_of(b, SimTime::min());
  const auto between_others = [&](SimTime at) {
    DecisionRecord d = record(at);
    d.collider = b;
    d.collidee = c;
    return d;
  };
  EXPECT_STREQ(decisions.on_decision(other, 1, between_others(sim(-1ms)), sim(10s)), "decision_before_life");
  EXPECT_EQ(decisions.on_decision(other, 2, between_others(sim(0s)), sim(10s)), nullptr);
}

// This peer does not look for contacts of the two, by the policy `id`. It solves one that lasts all the same.
class Resting : public Deferring {
 protected:
  Resting() { EXPECT_EQ(decisions.on_decision(other, 1, resting(sim(10s)), sim(10s)), nullptr); }
  DecisionRecord resting(SimTime at) const {
    DecisionRecord d = record(at);
    d.rests = true;
    d.collider_after = d.collidee_after;
    return d;
  }
  bool rests() const { return decisions.authority(a, b, sim(11s)) == ContactAuthority::kDeferred; }
};

TEST_F(Resting, LastsUntilTheNextBlow) {
  EXPECT_TRUE(rests());
  ASSERT_EQ(decisions.on_decision(other, 2, record(sim(11s)), sim(11s)), nullptr);
  EXPECT_FALSE(rests());
  ASSERT_EQ(decisions.on_decision(other, 3, resting(sim(12s)), sim(12s)), nullptr);
  EXPECT_TRUE(rests());
}

TEST_F(Resting, LastsWithinTheSessionAlone) {
  decisions.restart(true);
  EXPECT_TRUE(rests());
  decisions.restart(false);
  EXPECT_FALSE(rests());
}

TEST_F(Resting, EndsWithALifeOfEither) {
  decisions.end_life_of(b, sim(11s));
  EXPECT_FALSE(rests());
  ASSERT_EQ(decisions.on_decision(other, 2, resting(sim(11s)), sim(11s)), nullptr);
  EXPECT_TRUE(rests());
  decisions.forget(b, sim(12s));
  EXPECT_FALSE(rests());
  ASSERT_EQ(decisions.on_decision(other, 3, resting(sim(12s)), sim(12s)), nullptr);
  EXPECT_TRUE(rests());
  decisions.remove(a);
  EXPECT_FALSE(rests());
}

// Another owner that decides in its turn goes on with it.
TEST_F(Resting, LastsAsLongAsAnotherOwnerDecides) {
  const auto give = [&](ObjectId object, PeerId owner) {
    owners.set(object, owner);
    decisions.watch().follow_owners_of({&object, 1});
  };
  give(b, PeerId{1});
  EXPECT_TRUE(rests());
  give(b, kNobody);
  give(b, PeerId{1});
  EXPECT_FALSE(rests()) << "it ended when nobody owned the other one";
  ASSERT_EQ(decisions.on_decision(PeerId{1}, 2, resting(sim(11s)), sim(11s)), nullptr);
  EXPECT_TRUE(rests());
  give(b, PeerId{9});
  EXPECT_EQ(decisions.authority(a, b, sim(11s)), ContactAuthority::kLocal) << "this peer has the lower id";
  give(b, PeerId{1});
  EXPECT_FALSE(rests());
}

TEST_F(Deferring, ADecisionCountsOnceAndOfItsDeciderAlone) {
  EXPECT_STREQ(decisions.on_decision(PeerId{9}, 1, record(), sim(10s)), "not_decider");
  for (const ObjectId stranger : {ObjectId{999}, world["A/0"], a}) {
    DecisionRecord none = record();
    none.collidee = stranger;
    EXPECT_STREQ(decisions.on_decision(other, 1, none, sim(10s)), "no_pair");
  }
  EXPECT_EQ(decisions.on_decision(other, 1, record(), sim(10s)), nullptr);
  EXPECT_STREQ(decisions.on_decision(other, 2, record(), sim(10s)), "decision_known");
  EXPECT_EQ(decided(), 1u);
}

TEST_F(Deferring, AnObjectPublishedSinceTheContactIsPublishedAnew) {
  own.at(a).last_sent = sim(10s);
  ASSERT_EQ(decisions.on_decision(other, 1, record(), sim(10s)), nullptr);
  EXPECT_FALSE(own.at(a).republish);
  own.at(a).last_sent = sim(10500ms);
  ASSERT_EQ(decisions.on_decision(other, 2, record(sim(10400ms)), sim(11s)), nullptr);
  EXPECT_TRUE(own.at(a).republish);
}

TEST_F(Deferring, ADecisionOnObjectsThatAreNotReceivedIsNotReported) {
  replica.set_received(b, false);
  ASSERT_EQ(decisions.on_decision(other, 1, record(), sim(10s)), nullptr);
  EXPECT_EQ(decided(), 0u);
  EXPECT_EQ(replica.truth(a, sim(11s)).position, Vec3(1, 0, 0)) << "it happened";
}

TEST_F(Deciding, WhatEachLeftToTheOtherTheLowerOneDecides) {
  conf.decisions.policy = DecisionPolicy::kServer;
  conf.decisions.server = other;
  decisions.defer(left_to_another(contact()));
  Hello hello;
  hello.notes.push_back({b, a, sim(10300ms), true});
  members.find(other)->delays.add(0ms);
  decisions.on_contact_notes(other, hello, sim(10400ms));
  EXPECT_EQ(counters.decisions_fallback, 1u);
  EXPECT_FALSE(decisions.has_deferred());
}

TEST_F(Deciding, WhatTheDeciderHasNotFoundIsRefuted) {
  conf.decisions.policy = DecisionPolicy::kServer;
  conf.decisions.server = other;
  decisions.defer(left_to_another(contact()));
  Hello hello;
  members.on_datagram(host(1s), PeerId{9}, 1);
  for (const PeerId sender : {other, PeerId{9}}) members.find(sender)->delays.add(0ms);
  const SimTime answered = sim(10s) + members.longest_latency();
  decisions.on_contact_notes(other, hello, answered - 1ns);
  EXPECT_TRUE(decisions.has_deferred()) << "it could not know yet";
  hello.notes.push_back({b, a, sim(10300ms), false});
  decisions.on_contact_notes(other, hello, answered);
  EXPECT_TRUE(decisions.has_deferred()) << "its decision is on the way";
  hello.notes.clear();
  decisions.on_contact_notes(PeerId{9}, hello, answered);
  EXPECT_TRUE(decisions.has_deferred()) << "that one was not to decide";
  decisions.on_contact_notes(other, hello, answered);
  EXPECT_FALSE(decisions.has_deferred());
  EXPECT_EQ(counters.contacts_refuted, 1u);
  EXPECT_EQ(counters.decisions, 0u);
}

// ---- what goes out ----

class Sent : public Deciding {
 protected:
  Sent() {
    decisions.decide(contact(), sim(10s));
    DecisionLog::Entry& entry = decisions.entries().at(0);
    entry.copies = 0;
    decisions.note_sent(std::vector{entry.record}, 7);
  }
  int copies() { return decisions.entries().at(0).copies; }
  static Acknowledgement of(const Received& received) {
    Acknowledgement acknowledgement(Received{1, 1, 1});
    acknowledgement.received = received;
    return acknowledgement;
  }
};

TEST_F(Sent, IsNotedUntilAllHaveIt) {
  for (const PeerId peer : {other, PeerId{9}}) {
    EXPECT_EQ(decisions.notes().size(), 1u);
    decisions.on_acknowledgement(peer, of({7, 7, ~std::uint64_t{0}}));
  }
  EXPECT_TRUE(decisions.notes().empty());
  EXPECT_EQ(copies(), 0);
  decisions.on_new_session_of(other);
  EXPECT_EQ(decisions.notes().size(), 1u) << "it has forgotten all";
}

TEST_F(Sent, WhatIsSurelyLostIsRepeatedAtOnce) {
  decisions.on_acknowledgement(other, of({6, 6, ~std::uint64_t{0}}));
  EXPECT_EQ(copies(), 0) << "it may be under way";
  decisions.on_acknowledgement(other, of({9, 2, ~std::uint64_t{0b100}}));
  EXPECT_EQ(copies(), 1);
  EXPECT_EQ(counters.decisions_repeated, 1u);
}

TEST_F(Sent, WhatIsUnacknowledgedIsRepeatedWithAHello) {
  const Duration answered = members.acknowledged_within(conf.settled_hello_period);
  tick_to(10s);
  decisions.repeat_unacknowledged();
  EXPECT_EQ(copies(), 0) << "nobody could have answered";
  tick_to(10s + answered + 20ms);
  decisions.repeat_unacknowledged();
  EXPECT_EQ(copies(), 1);
  decisions.entries().at(0).copies = 0;
  conf.decisions.repeat = false;
  decisions.repeat_unacknowledged();
  EXPECT_EQ(copies(), 0);
  conf.decisions.repeat = true;
  tick_to(15s + 20ms);
  decisions.repeat_unacknowledged();
  EXPECT_EQ(copies(), 0) << "receivers would drop it soon";
}

TEST_F(Sent, AStepWithinTheSessionForgetsNoDecision) {
  decisions.restart(true);
  EXPECT_FALSE(decisions.log().entries().empty());
}

TEST_F(Sent, AnotherSessionForgetsEverything) {
  decisions.restart(false);
  EXPECT_TRUE(decisions.notes().empty());
  EXPECT_TRUE(decisions.log().entries().empty());
}

TEST_F(Deciding, ACameraIsWhereItsCarrierIsKnownToBe) {
  Viewpoint view;
  view.pose.position = {1, 2, 3};
  EXPECT_EQ(decisions.camera_pose(view, sim(10s))->position, Vec3(1, 2, 3));
  replica.ghosts().set_base(b, sim(5s), moving({0, 10, 0}));
  view.object = b;
  EXPECT_EQ(decisions.camera_pose(view, sim(10s))->position, Vec3(1, 12, 3));
  replica.ghosts().advance(sim(60s));
  EXPECT_FALSE(decisions.camera_pose(view, sim(1s))) << "too long ago";
}

}  // namespace peerd::replication::contact_decisions_test
