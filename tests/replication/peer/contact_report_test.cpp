#include "replication/peer/contact_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/edit/scene_editor.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::contact_report_test {

using namespace test;

// BALL flies at 2 m/s from the middle of a corridor and reaches its RIGHT wall after 1.5 s.
class Reporting : public testing::Test {
 protected:
  // The peers that own BALL and RIGHT; peer 2 is this one.
  void begin(PeerId ball_owner, PeerId wall_owner) {
    std::vector<OwnedObject> owned;
    if (ball_owner == PeerId{2}) owned.push_back({ball});
    if (wall_owner == PeerId{2}) owned.push_back({right});
    p.emplace(config(2, owned), *world.model);
    p->owners.set(ball, ball_owner);
    p->owners.set(right, wall_owner);
    for (const std::uint32_t id : {1u, 3u}) add_member(p->members, id);
    p->replica.begin(sim(0s));
    p->replica.truth().set_authority(
        {[this](ObjectId a, ObjectId b, SimTime at) { return p->decisions.authority(a, b, at); }, {}});
    for (const auto& [object, owner] : p->owners) {
      if (p->own.contains(object)) {
        p->replica.truth().declare(object, Role::kAuthoritative);
        p->replica.ghosts().declare(object, Role::kPredicted);
      } else {
        p->replica.declare_remote(object, Role::kPredicted);
      }
    }
    p->decisions.watch().follow_all();
    for (MotionWorld* each : {&p->replica.truth(), &p->replica.ghosts()}) {
      each->set_base(ball, sim(0s), moving({0, 0, 0}, {2, 0, 0}));
    }
  }
  std::vector<Output> report(Duration t) {
    p->ticks.set_last(p->ticks.number_at(sim(t)));
    p->replica.truth().advance(sim(t));
    p->replica.ghosts().advance(sim(t));
    report_contacts(*p, sim(t));
    std::vector<Output> all;
    while (auto out = p->outbox.poll()) all.push_back(std::move(*out));
    return all;
  }
  template <class Kind>
  static std::vector<Kind> only(const std::vector<Output>& outputs) {
    std::vector<Kind> all;
    for (const Output& out : outputs) {
      if (const auto* kind = std::get_if<Kind>(&out)) all.push_back(*kind);
    }
    return all;
  }

  World world{corridor()};
  ObjectId ball = world["BALL"], right = world["RIGHT"];
  std::optional<PeerParts> p;
};

struct Case {
  const char* name;
  std::uint32_t ball_owner, wall_owner;  // 0: nobody
  std::optional<ContactKind> kind;
};
class Kinds : public Reporting, public testing::WithParamInterface<Case> {};
TEST_P(Kinds, AreByWhoOwnsTheTwo) {
  begin(PeerId{GetParam().ball_owner}, PeerId{GetParam().wall_owner});
  EXPECT_TRUE(only<ContactSeen>(report(1490ms)).empty());
  const auto seen = only<ContactSeen>(report(1510ms));
  ASSERT_EQ(seen.size(), GetParam().kind ? 1u : 0u);
  if (!GetParam().kind) return;
  EXPECT_EQ(seen[0].kind, *GetParam().kind);
  EXPECT_EQ(seen[0].contact.at, sim(1500ms));
  EXPECT_EQ(seen[0].known_at, sim(1510ms));
  EXPECT_EQ(seen[0].contact.collider, ball);
  EXPECT_TRUE(only<ContactSeen>(report(1530ms)).empty()) << "once";
}
INSTANTIATE_TEST_SUITE_P(Table, Kinds,
                         testing::Values(Case{"OwnAndTheScenes", 2, 0, ContactKind::kOwner},
                                         Case{"BothOwn", 2, 2, ContactKind::kOwner},
                                         Case{"RemoteAndTheScenes", 3, 0, ContactKind::kPredicted},
                                         Case{"BothRemote", 1, 3, ContactKind::kPredicted}),
                         [](const auto& c) { return std::string(c.param.name); });

// The two have met, and before that is reported an edit takes one of them away, with its polygons: the contact is
// reported without them, and nobody decides it.
TEST_P(Kinds, OfWhatAnEditHasTakenAwayAreNotDecided) {
  begin(PeerId{GetParam().ball_owner}, PeerId{GetParam().wall_owner});
  (void)report(1490ms);
  p->replica.truth().advance(sim(1510ms));
  p->replica.ghosts().advance(sim(1510ms));
  SceneEditor editor(world.scene);
  ASSERT_TRUE(editor.remove(right));
  auto scene = editor.finish();
  ASSERT_TRUE(scene);
  p->change_scene(std::make_shared<const Scene>(*std::move(scene)), sim(1510ms));
  const auto outputs = report(1510ms);
  for (const ContactSeen& seen : only<ContactSeen>(outputs)) {
    EXPECT_THAT(seen.kind, testing::AnyOf(ContactKind::kOwner, ContactKind::kPredicted));
    EXPECT_TRUE(seen.contact.polygons.pairs.empty());
  }
  EXPECT_EQ(only<ContactSeen>(outputs).size(), 1u);
}

// Whoever reports it: the least of the polygons that touch, as it is a witness that the interest asks for.
TEST_P(Kinds, SayTheTypeAndThePolygons) {
  begin(PeerId{GetParam().ball_owner}, PeerId{GetParam().wall_owner});
  for (const ContactSeen& seen : only<ContactSeen>(report(1510ms))) {
    EXPECT_EQ(seen.contact.type, CollisionType::kWitness);
    ASSERT_EQ(seen.contact.polygons.pairs.size(), 1u);
    EXPECT_EQ(world.scene.path_of(seen.contact.polygons.pairs[0].collider.shape), "BALL/0");
    EXPECT_EQ(world.scene.path_of(seen.contact.polygons.pairs[0].collidee.shape), "RIGHT/0");
  }
}

// Nobody answers the two, so that each of their interests has a contact of its own, also of one instant.
TEST(ReportingTypes, OfTwoInterestsInAPairBothAreReported) {
  const World world(box("A", "1 1 1", "-2.5 0 0") + box("B", "1 1 1", "0 0 0") + interest("A", "\"B\"", 0) +
                    interest("A", "\"B\"", 2));
  for (const bool decides : {true, false}) {
    PeerParts p(config(2, {{world["A"]}}), *world.model);
    p.owners.set(world["A"], PeerId{2});
    p.owners.set(world["B"], PeerId{decides ? 3u : 1u});
    for (const std::uint32_t id : {1u, 3u}) add_member(p.members, id);
    p.replica.begin(sim(0s));
    p.replica.truth().declare(world["A"], Role::kAuthoritative);
    p.replica.ghosts().declare(world["A"], Role::kPredicted);
    p.replica.declare_remote(world["B"], Role::kPredicted);
    p.decisions.watch().follow_all();
    for (MotionWorld* each : {&p.replica.truth(), &p.replica.ghosts()}) {
      each->set_base(world["A"], sim(0s), moving({-2.5, 0, 0}, {1, 0, 0}));
    }
    p.ticks.set_last(p.ticks.number_at(sim(2s)));
    p.replica.truth().advance(sim(2s));
    p.replica.ghosts().advance(sim(2s));
    report_contacts(p, sim(2s));
    std::vector<CollisionType> types;
    while (auto out = p.outbox.poll()) {
      const auto* seen = std::get_if<ContactSeen>(&*out);
      if (seen != nullptr && seen->kind == (decides ? ContactKind::kDecided : ContactKind::kPredicted)) {
        types.push_back(seen->contact.type);
      }
    }
    std::ranges::sort(types);
    EXPECT_EQ(types, (std::vector{CollisionType::kBox, CollisionType::kAllPairs})) << decides;
  }
}

TEST_F(Reporting, AContactWithAHigherIdsObjectIsDecidedHere) {
  begin(PeerId{2}, PeerId{3});
  const auto seen = only<ContactSeen>(report(1510ms));
  const auto decided = std::ranges::find(seen, ContactKind::kDecided, &ContactSeen::kind);
  ASSERT_NE(decided, seen.end());
  EXPECT_EQ(decided->contact.polygons.count, 1u);
  EXPECT_EQ(std::ranges::count(seen, ContactKind::kDecided, &ContactSeen::kind), 1);
  EXPECT_EQ(p->counters.decisions, 1u);
}

TEST_F(Reporting, AContactWithALowerIdsObjectIsLeftToIt) {
  begin(PeerId{2}, PeerId{1});
  const auto seen = only<ContactSeen>(report(1510ms));
  EXPECT_EQ(std::ranges::count(seen, ContactKind::kDecided, &ContactSeen::kind), 0);
  EXPECT_EQ(std::ranges::count(seen, ContactKind::kPredicted, &ContactSeen::kind), 1);
  EXPECT_EQ(p->counters.decisions, 0u);
}

// Found after the last report of a tick, as contacts are that follow from what a report does.
TEST_F(Reporting, AContactThatIsRetractedBeforeItsReportIsNone) {
  begin(PeerId{2}, kNobody);
  p->replica.truth().advance(sim(1510ms));
  p->replica.truth().set_base(ball, sim(1400ms), moving({2.8, 0, 0}, {-2, 0, 0}));
  EXPECT_TRUE(only<ContactSeen>(report(1520ms)).empty());
}

// The ghosts have found it, gone through that time again for an update that came late, and found another one.
TEST_F(Reporting, APredictedContactThatIsRetractedBeforeItsReportIsNone) {
  begin(PeerId{1}, PeerId{3});
  p->replica.ghosts().advance(sim(1510ms));
  p->replica.ghosts().set_base(ball, sim(1400ms), moving({2.8, 0, 0}, {1, 0, 0}));
  EXPECT_TRUE(only<ContactSeen>(report(1520ms)).empty());
  const auto seen = only<ContactSeen>(report(1700ms));
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].contact.at, sim(1600ms));
}

// Two updates that come late take back what has been reported, and the second one what followed from the first.
TEST_F(Reporting, ContactsOfEarlierTicksAreRetractedOnce) {
  begin(PeerId{1}, PeerId{3});
  const auto before = only<ContactSeen>(report(1510ms));
  ASSERT_EQ(before.size(), 1u);
  MotionWorld& ghosts = p->replica.ghosts();
  ghosts.set_base(ball, sim(1400ms), moving({2.8, 0, 0}, {1.9, 0, 0}));
  ghosts.advance(sim(1520ms));
  ghosts.set_base(ball, sim(1410ms), moving({2.82, 0, 0}, {2, 0, 0}));
  const auto outputs = report(1520ms);
  const auto retracted = only<ContactsRetracted>(outputs);
  ASSERT_EQ(retracted.size(), 1u);
  EXPECT_TRUE(retracted[0].retracts(before[0].contact.at, ball, right));
  const auto seen = only<ContactSeen>(outputs);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].contact.at, sim(1500ms));
  EXPECT_TRUE(std::holds_alternative<ContactsRetracted>(outputs.front())) << "it would take back the new one, too";
}

// It has bounced off and away again by the tick that finds the contact.
TEST_F(Reporting, WhatTouchesCollidesUntilItIsFoundApart) {
  begin(PeerId{2}, kNobody);
  auto changes = only<NotColliding>(report(1510ms));
  const auto later = only<NotColliding>(report(1700ms));
  changes.insert(changes.end(), later.begin(), later.end());
  std::erase_if(changes, [&](const NotColliding& each) { return each.object != ball; });
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_FALSE(changes[0].value);
  EXPECT_EQ(changes[0].at, sim(1500ms));
  EXPECT_TRUE(changes[1].value);
  EXPECT_GT(changes[1].at, sim(1500ms));
}

}  // namespace peerd::replication::contact_report_test
