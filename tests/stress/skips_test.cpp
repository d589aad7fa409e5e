// A peer does no work that a scene does not need: for each kind of work a counter stays 0. README.md has the whole
// table; here are the rows that no other test has.
#include "collision/scene/collision_watch.hpp"
#include "core/scene/reader.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::skips_test {

using namespace test;

const std::string kTwoBalls =
    "DEF A Transform { children DEF S Shape { geometry Sphere { } } }\n"
    "DEF B Transform { translation 0.5 0 0 children Shape { geometry Sphere { } } }\n";

TEST(Skips, WithoutInterestsNoMeshIsMadeAndNoBoxTested) {
  const World world(kTwoBalls);
  collision::CollisionWatch watch(world.scene);
  for (int tick = 0; tick < 3; ++tick) EXPECT_TRUE(watch.tick().colliding.empty());
  const auto counters = watch.counters();
  EXPECT_EQ(counters.query.meshes_built, 0u);
  EXPECT_EQ(counters.query.soups_built, 0u);
  EXPECT_EQ(counters.query.hierarchies_built, 0u);
  EXPECT_EQ(counters.query.boxes_placed, 0u);
  EXPECT_EQ(counters.broad.box_tests, 0u);
  EXPECT_EQ(counters.pairs_queried, 0u);
}

TEST(Skips, AWitnessIsOnePairAndNoMore) {
  const World world(kTwoBalls);
  const auto tests = [&](CollisionType type) {
    collision::SceneQuery query(world.scene);
    EXPECT_TRUE(query.collide(world["A"], world["B"], type)->colliding);
    return query.counters().queries.triangle_tests;
  };
  const std::uint64_t witness = tests(CollisionType::kWitness), all = tests(CollisionType::kAllPairs);
  EXPECT_GT(witness, 0u);
  EXPECT_LE(witness, 64u) << "two leaves of eight";
  EXPECT_GT(all, 4 * witness);
  EXPECT_EQ(tests(CollisionType::kBox), 0u);
}

// Two peers; `owned` is the first one's, if anything is.
struct Session {
  Session(const World& world, std::vector<OwnedObject> of_first, std::vector<OwnedObject> of_second,
          const std::function<void(PeerConfig&)>& change = {})
      : lan(world, {5ms, 0ms, 0, 0}) {
    lan.on_send = [this](std::size_t, RegionId region, const Message& m) {
      if (m.hello) ++with_hello;
      if (!m.updates.empty() || !m.decisions.empty() || !m.subscriptions.empty() || !m.handovers.empty()) ++with_more;
      elsewhere += region != kWholeScene;
    };
    for (const std::uint32_t id : {1u, 2u}) {
      PeerConfig c = config(id, id == 1 ? std::move(of_first) : std::move(of_second));
      if (change) change(c);
      lan.add(c);
    }
    lan.run_until(15s);
  }
  [[nodiscard]] const Peer::Counters& counters(std::size_t i) const { return lan.peer(i).counters(); }
  std::uint64_t with_hello = 0, with_more = 0, elsewhere = 0;
  Lan lan;
};

const std::string kMeeting = box("A", "1 1 1", "-4 0 0", std::string(kBounces) + "velocityVector 1 0 0 ") +
                             box("B", "1 1 1", "4 0 0", std::string(kBounces) + "velocityVector -1 0 0 ") +
                             interest("A", "\"B\"") + interest("B", "\"A\"");

TEST(Skips, WhoRunsNothingSendsBeaconsAlone) {
  const World world(kMeeting);
  const Session run(world, {}, {});
  EXPECT_GT(run.with_hello, 50u);
  EXPECT_EQ(run.with_more, 0u);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(run.counters(i).updates_out, 0u);
    const auto motion = run.lan.peer(i).motion_counters();
    EXPECT_EQ(motion.contact_searches + motion.searches_far, 0u) << "nobody runs what an interest names";
  }
}

TEST(Skips, WithoutRemoteObjectsNothingIsDecidedAndNoProximityTested) {
  const World world(kMeeting);
  const Session run(world, {{world["A"], false}, {world["B"], false}}, {});
  EXPECT_GE(run.lan.contacts(0, ContactKind::kOwner).size(), 1u) << "they do meet";
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(run.counters(i).decisions + run.counters(i).contacts_held, 0u);
    EXPECT_EQ(run.counters(i).proximity_tests, 0u);
    EXPECT_EQ(run.counters(i).updates_relayed, 0u);
  }
}

TEST(Skips, ByIdTheOneThatDoesNotDecideHoldsNothingAndNobodyFallsBack) {
  const World world(kMeeting);
  const Session run(world, {{world["A"], false}}, {{world["B"], false}});
  EXPECT_EQ(run.counters(0).decisions, 1u);
  EXPECT_EQ(run.counters(1).decisions, 0u);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(run.counters(i).contacts_held + run.counters(i).decisions_fallback, 0u);
  }
}

TEST(Skips, WithoutPredictionGhostsMeetNothing) {
  const World world(kMeeting);
  const Session run(world, {{world["A"], false}, {world["B"], false}}, {},
                    [](PeerConfig& c) { c.policy.predict_collisions = false; });
  EXPECT_GE(run.lan.contacts(0, ContactKind::kOwner).size(), 1u);
  EXPECT_TRUE(run.lan.contacts(1, ContactKind::kPredicted).empty());
  const auto motion = run.lan.peer(1).motion_counters();
  EXPECT_EQ(motion.contact_searches + motion.searches_far, 0u) << "this one's ghosts are all that it has";
}

TEST(Skips, WithoutTrackingNoProximityIsAskedAndWithoutRefiningNoSurface) {
  const World world(kMeeting);
  const Session without(world, {{world["A"], false}}, {{world["B"], false}},
                        [](PeerConfig& c) { c.policy.track_proximity = false; });
  const Session with(world, {{world["A"], false}}, {{world["B"], false}});
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(without.counters(i).proximity_tests, 0u);
    EXPECT_GT(with.counters(i).proximity_tests, 0u);
    EXPECT_EQ(with.counters(i).proximity_refined, 0u);
  }
}

TEST(Skips, RestingObjectsAreNotChecked) {
  const World world(box("A", "1 1 1", "-4 0 0", kBounces) + box("B", "1 1 1", "4 0 0", kBounces) +
                    interest("A", "\"B\""));
  Session run(world, {{world["A"], false}}, {{world["B"], false}});
  const Peer::Counters before = run.counters(0);
  run.lan.run_until(25s);
  EXPECT_EQ(run.counters(0).ticks, before.ticks + 600);
  EXPECT_EQ(run.counters(0).objects_looked_at, before.objects_looked_at);
  EXPECT_EQ(run.counters(0).proximity_tests, before.proximity_tests);
}

TEST(Skips, WithoutACutNoRegionIsJoinedAndNothingHandedOver) {
  const World world(kMeeting);
  const Session run(world, {{world["A"], false}}, {{world["B"], false}});
  EXPECT_EQ(run.elsewhere, 0u);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(run.lan.seen<Join>(i).size(), 1u) << "the whole scene";
    const Peer::Counters& c = run.counters(i);
    EXPECT_EQ(c.regions_joined + c.regions_left + c.handovers + c.sights_lost, 0u);
  }
}

TEST(Skips, WhatNobodyDrawsHasNoConvergence) {
  const World world(kMeeting + box("WALL", "1 50 50", "6 0 0"));
  const Session run(world, {{world["A"], false}}, {{world["B"], false}},
                    [](PeerConfig& c) { c.convergence.method = ConvergenceMethod::kLinear; });
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(run.counters(i).convergence_blocked + run.counters(i).convergence_detours, 0u);
  }
}

}  // namespace peerd::replication::skips_test
