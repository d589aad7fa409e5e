#include "replication/objects/updates/publication.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "replication/peer/peer_parts.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::publication_test {

using namespace test;

// A publication, by default of cubes that stand in a row and meet nothing. Peer 1 owns O0, which is driven, and O1,
// which physics moves; peer 2 owns the others.
struct Publishing {
  explicit Publishing(const PublishPolicy& policy = {}, int objects = 3) : Publishing(policy, field(objects)) {}
  Publishing(const PublishPolicy& policy, const std::string& text) : world(text), p(make(policy), *world.model) {
    echo_us(add_member(p.members, 2), 0.001);
    for (const auto& [object, owner] : p.owners) p.own.at(object).delivery.acknowledged_by.clear();
    p.replica.begin(sim(0s));
    for (const auto& [object, own] : p.own) {
      p.replica.truth().declare(object, own.driven ? Role::kDriven : Role::kAuthoritative);
      p.replica.ghosts().declare(object, Role::kPredicted);
    }
  }
  PeerConfig make(PublishPolicy policy) const {
    policy.error_threshold_m = 0.5;
    PeerConfig c = config(1, {{world["O0"], true}, {world["O1"], false}});
    c.policy = policy;
    return c;
  }
  // O0 is at that place, without a velocity, at this tick.
  std::vector<Published> tick(Duration t, const KinematicState& driven = moving({0, 0, 0})) {
    p.ticks.set_last(p.ticks.number_at(sim(t)));
    p.replica.truth().advance(sim(t));
    const std::vector<OwnSample> samples{{world["O0"], driven}};
    p.publication.take(sim(t), samples);
    p.replica.ghosts().advance(sim(t));
    p.publication.publish(sim(t));
    return drain<Published>(p.outbox);
  }
  std::vector<UpdateRecord> flushed(Duration t) {
    p.publication.flush(true);
    std::vector<UpdateRecord> all;
    for (const auto& [region, message] : drain_messages(p.outbox, sim(t))) {
      all.insert(all.end(), message.updates.begin(), message.updates.end());
    }
    return all;
  }

  World world;
  PeerParts p;
};

TEST(Publication, FirstStatesGoOutAndThenNothingThatEverybodyKnows) {
  Publishing s;
  const auto first = s.tick(1s);
  ASSERT_EQ(first.size(), 2u);
  for (const Published& each : first) EXPECT_EQ(each.reason, PublishReason::kFirst);
  EXPECT_EQ(first[0].threshold_m, 0.5);
  const auto sent = s.flushed(1s);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].object, s.world["O0"]);
  EXPECT_EQ(sent[0].sequence, 1u);
  EXPECT_EQ(sent[0].at, sim(1s));
  EXPECT_EQ(s.p.own.at(s.world["O0"]).delivery.sent_in, std::vector{1u});
  for (Duration t = 1100ms; t < 5900ms; t += 100ms) EXPECT_TRUE(s.tick(t).empty()) << to_seconds(t);
  EXPECT_TRUE(s.flushed(6s).empty());
  EXPECT_EQ(s.p.counters.updates_out, 2u);
  EXPECT_EQ(std::reduce(s.p.counters.update_sizes_out.begin(), s.p.counters.update_sizes_out.end()), 2u);
  EXPECT_GT(s.p.counters.update_bytes_out, 10u);
}

TEST(Publication, AnErrorBeyondTheThresholdIsPublished) {
  Publishing s;
  (void)s.tick(1s);
  EXPECT_TRUE(s.tick(2s, moving({0.49, 0, 0})).empty());
  const auto due = s.tick(2100ms, moving({0.51, 0, 0}));
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].object, s.world["O0"]);
  EXPECT_EQ(due[0].reason, PublishReason::kError);
  EXPECT_EQ(s.p.own.at(s.world["O0"]).sequence, 2u);
  EXPECT_NEAR(s.p.replica.ghost(s.world["O0"], sim(2100ms)).position.x(), 0.51, 0.5 / 16) << "as receivers have it";
}

struct WhyCase {
  const char* name;
  bool acknowledged, resend, republish;
  Duration next;  // after the first one
  PublishReason reason;
};
class Why : public testing::TestWithParam<WhyCase> {};
// A resting object is published to all once in 5 s, and once in a minute when all have acknowledged its state.
TEST_P(Why, IsAnUpdateDueOfWhatRests) {
  const WhyCase& c = GetParam();
  Publishing s;
  (void)s.tick(1s);
  for (const auto& [object, own] : std::as_const(s.p.own)) {
    OwnObject& each = s.p.own.at(object);
    if (c.acknowledged) each.delivery.acknowledged_by.insert(PeerId{2});
    if (c.republish) s.p.own.republish(object);
  }
  if (c.resend) s.p.own.resend_all();
  if (c.next > 100ms) {
    EXPECT_TRUE(s.tick(1s + c.next - 100ms).empty());
  }
  const auto due = s.tick(1s + c.next);
  ASSERT_EQ(due.size(), 2u);
  for (const Published& each : due) EXPECT_EQ(each.reason, c.reason);
  EXPECT_FALSE(s.p.own.at(s.world["O1"]).resend || s.p.own.at(s.world["O1"]).republish) << "that is done";
}
INSTANTIATE_TEST_SUITE_P(Table, Why,
                         testing::Values(WhyCase{"Time", false, false, false, 5s, PublishReason::kTime},
                                         WhyCase{"RestingTime", true, false, false, 60s, PublishReason::kTime},
                                         WhyCase{"Joiner", true, true, false, 100ms, PublishReason::kJoiner},
                                         WhyCase{"Decision", true, false, true, 100ms, PublishReason::kDecision}),
                         [](const auto& c) { return std::string(c.param.name); });

// A ghost that is off by less than the threshold is mended once its object rests: it would stand there for a minute.
TEST(Publication, WhatRestsIsPublishedExactly) {
  Publishing s;
  (void)s.tick(1s);
  const ObjectId object = s.world["O1"];
  MotionModel off = s.p.replica.ghosts().model_at(object, sim(1s));
  off.state.position.x() += 0.006;
  s.p.replica.ghosts().set_base(object, sim(1100ms), off);
  std::size_t updates = 0;
  for (Duration t = 1200ms; t < 5900ms; t += 100ms) {
    for (const Published& each : s.tick(t)) {
      EXPECT_EQ(each.object, object) << "what is driven may be off by the threshold";
      EXPECT_EQ(each.reason, PublishReason::kError);
      EXPECT_GE(t, Duration(2s));
      ++updates;
    }
  }
  EXPECT_EQ(updates, 1u);
  EXPECT_EQ(s.p.replica.ghost(object, sim(6s)).position, s.p.replica.truth(object, sim(6s)).position);
}

// All have acknowledged its last update, but it has moved on since, by less than the threshold.
TEST(Publication, WhatIsDrivenAndStandsElsewhereIsToldWhenItsTimeIsUp) {
  Publishing s;
  (void)s.tick(1s);
  for (const auto& [object, own] : std::as_const(s.p.own)) {
    s.p.own.at(object).delivery.acknowledged_by.insert(PeerId{2});
  }
  for (Duration t = 1100ms; t < 6s; t += 100ms) EXPECT_TRUE(s.tick(t, moving({0.3, 0, 0})).empty());
  const auto due = s.tick(6s, moving({0.3, 0, 0}));
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].object, s.world["O0"]);
  EXPECT_EQ(due[0].reason, PublishReason::kTime);
}

// A support is published exactly: were it rounded, the box on it would be inside it, or above it.
TEST(Publication, WhatIsDrivenAndStopsUnderAnotherIsPublishedExactlyAndAtOnce) {
  Publishing s({}, box("O0", "4 1 4", "0 0 0") +
                       box("O1", "1 1 1", "0 1 0", " collisionResponse CollisionResponse { responseType 2 } ") +
                       box("O2", "1 1 1", "50 0 0") + interest("O1", R"("O0")"));
  const ObjectId lift = s.world["O0"];
  for (MotionWorld* const each : {&s.p.replica.truth(), &s.p.replica.ghosts()}) {
    each->watch_by([](const CollisionPair&) { return true; });
    each->set_base(s.world["O1"], sim(0s), moving({0, 1, 0}, {0, 0, 0}, {0, -9.81, 0}));
  }
  (void)s.tick(1s);
  (void)s.flushed(1s);
  const double stops_at = -0.123456789;  // less than the threshold
  for (Duration t = 1100ms; t < 1900ms; t += 100ms) {
    const double y = stops_at * to_seconds(t - 1s);
    for (const Published& each : s.tick(t, moving({0, y, 0}, {0, stops_at, 0}))) EXPECT_NE(each.object, lift);
  }
  (void)s.flushed(1900ms);
  const auto due = s.tick(2s, moving({0, stops_at, 0}));
  EXPECT_EQ(std::ranges::count(due, lift, &Published::object), 1);
  const auto updates = s.flushed(2s);
  const auto update = std::ranges::find(updates, lift, &UpdateRecord::object);
  ASSERT_NE(update, updates.end());
  EXPECT_EQ(update->model.state.position, Vec3(0, stops_at, 0));
  EXPECT_TRUE(is_motionless(update->model.state));
}

TEST(Publication, ObjectsThatPhysicsMovesAndThatRestAreNotCheckedAtEachTick) {
  Publishing s;
  (void)s.tick(1s);
  (void)s.tick(1100ms);
  const std::uint64_t before = s.p.counters.objects_looked_at;
  for (Duration t = 1200ms; t < 3s; t += 100ms) (void)s.tick(t);
  EXPECT_EQ(s.p.counters.objects_looked_at - before, 18u) << "the driven one alone";
}

TEST(Publication, TakesSamplesOfItsOwnObjectsAlone) {
  Publishing s;
  const std::vector<OwnSample> samples{{s.world["O2"], moving({7, 7, 7})}, {s.world["O0"], moving({1, 2, 3})}};
  s.p.publication.take(sim(1s), samples);
  EXPECT_EQ(s.p.replica.truth(s.world["O0"], sim(1s)).position, Vec3(1, 2, 3));
  EXPECT_EQ(s.p.replica.truth(s.world["O2"], sim(1s)).position, Vec3(6, 0, 0)) << "another's";
}

TEST(Publication, SamplesBeyondTheWiresLimitsAreTakenAtRest) {
  Publishing s;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  s.p.publication.take(sim(1s), std::vector<OwnSample>{{s.world["O0"], moving({1, 2, 3}, {1e13, 0, 0})}});
  EXPECT_EQ(s.p.counters.states_out_of_range, 1u);
  EXPECT_EQ(s.p.replica.truth(s.world["O0"], sim(1s)).velocity, Vec3(0, 0, 0));
  EXPECT_EQ(s.p.replica.truth(s.world["O0"], sim(1s)).position, Vec3(1, 2, 3));
  s.p.publication.take(sim(1100ms), std::vector<OwnSample>{{s.world["O0"], moving({1, nan, 3}, {nan, 0, 0})}});
  EXPECT_EQ(s.p.counters.states_out_of_range, 2u);
  EXPECT_TRUE(s.p.replica.truth(s.world["O0"], sim(1100ms)).position.allFinite());
}

TEST(Publication, AnUnpredictableChangeIsPublishedOfItsInstant) {
  Publishing s;
  (void)s.tick(1s);
  (void)s.flushed(1s);
  s.p.replica.truth().advance(sim(1050ms));
  s.p.launches.change_velocity(sim(1050ms), s.world["O1"], {2, 0, 0}, true);
  const auto due = s.tick(1100ms);
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].reason, PublishReason::kFirst);
  const auto sent = s.flushed(1100ms);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].at, sim(1050ms));
  EXPECT_EQ(sent[0].model.state.velocity, Vec3(2, 0, 0));
  EXPECT_FALSE(sent[0].position_step_log2) << "what is driven alone is rounded";
  EXPECT_TRUE(s.p.launches.unpublished().empty());
}

TEST(Publication, BetweenTicksOnlyWhatMayNotWait) {
  Publishing s;
  (void)s.tick(1s);
  const OwnSample small{s.world["O0"], moving({0.4, 0, 0})}, large{s.world["O0"], moving({0.6, 0, 0})};
  (void)s.tick(1100ms);
  EXPECT_FALSE(s.p.publication.is_urgent({s.world["O2"], moving({9, 9, 9})}, sim(1105ms))) << "another's";
  EXPECT_FALSE(s.p.publication.is_urgent({s.world["O0"], moving({1e13, 0, 0})}, sim(1105ms)));
  ASSERT_TRUE(s.p.publication.is_urgent(large, sim(1105ms)));
  s.p.replica.truth().set_base(large.object, sim(1105ms), large.state);
  s.p.publication.publish_at_once(sim(1105ms), std::vector{&large});
  EXPECT_EQ(drain<Published>(s.p.outbox).size(), 1u);
  EXPECT_FALSE(s.p.publication.is_urgent({s.world["O0"], moving({9, 0, 0})}, sim(1106ms))) << "once between two ticks";
  s.p.publication.publish_at_once(sim(1106ms), std::vector{&small});
  EXPECT_TRUE(drain<Published>(s.p.outbox).empty()) << "not beyond the threshold in force";
}

TEST(Publication, ARelayPassesOnWhatItIsGiven) {
  Publishing s;
  s.p.publication.relay({s.world["O2"], 9, sim(900ms), {}});
  const auto sent = s.flushed(1s);
  ASSERT_EQ(sent.size(), 1u);
  EXPECT_EQ(sent[0].object, s.world["O2"]);
  EXPECT_EQ(sent[0].sequence, 9u);
  EXPECT_EQ(sent[0].at, sim(900ms));
}

TEST(Publication, AStepOfSessionTimeVoidsWhatWaits) {
  Publishing s;
  (void)s.tick(1s);
  s.p.publication.restart();
  EXPECT_TRUE(s.flushed(1s).empty());
}

TEST(Publication, ManyRecordsShareFewDatagramsAndNoneIsLost) {
  Publishing s;
  constexpr std::uint32_t kRecords = 100;
  for (std::uint32_t i = 1; i <= kRecords; ++i) {
    s.p.publication.relay({s.world["O2"], i, sim(900ms), moving({0.1 * i, 0, 0}, {1.0 / 3.0, 0, 0})});
  }
  s.p.publication.flush(true);
  const auto messages = drain_messages(s.p.outbox, sim(1s));
  std::uint32_t next = 1;
  for (const auto& [region, message] : messages) {
    for (const UpdateRecord& u : message.updates) EXPECT_EQ(u.sequence, next++);
  }
  EXPECT_EQ(next, kRecords + 1);
  EXPECT_LE(messages.size(), s.p.counters.bytes_out / 900 + 1) << "all but the last are nearly full";
}

TEST(Publication, BeyondItsBytesUpdatesAreWithheld) {
  PublishPolicy policy;
  policy.bytes_per_s = 1.0;
  Publishing s(policy);
  (void)s.tick(1s);
  for (int i = 0; i < 8; ++i) {  // what else is sent takes the bytes
    Message m = s.p.outbox.blank();
    s.p.outbox.bytes().spend(kDatagramMax_bytes, true);
    s.p.outbox.send(m);
  }
  (void)s.flushed(1s);
  (void)s.tick(1100ms, moving({3, 0, 0}));  // a quarter of the rate is for updates: one may be owed
  (void)s.flushed(1100ms);
  EXPECT_TRUE(s.tick(1200ms, moving({6, 0, 0})).empty());
  EXPECT_GT(s.p.counters.updates_withheld, 0u);
}

}  // namespace peerd::replication::publication_test
