// Tests of what peers believe when other peers come and go, and when the network is partitioned, at times that the
// scenario names.

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::simulation_test {

using testing_support::Ran;
using testing_support::run_eq47;

constexpr double kLatency_ms = 100;
// A peer that is not received for so long is lost; the others notice it at a tick.
constexpr double kLostAfter_s = 1.75 + 1.0 / 60;
// Joining a session takes this long: listening, and a clock that has settled.
constexpr double kJoining_s = 3.0;

Ran run(std::vector<std::string> events) { return run_eq47("dr+rcp+acpt", 2, kLatency_ms, std::move(events)); }

const std::string kApart = "event.apart={at_s = 4, kind = \"partition\", groups = [[\"a\"]]}";
const std::string kTogether = "event.together={at_s = 7, kind = \"heal\"}";

// An observer's views of an object between two times.
std::vector<measure::GhostSample> views(const Ran& ran, const std::string& observer, const std::string& path,
                                        double from_s, double until_s) {
  const auto who = std::ranges::find(ran.record.peers, observer, &measure::PeerInfo::name)->peer;
  const auto what = std::ranges::find(ran.record.objects, path, &measure::ObjectInfo::path)->object;
  std::vector<measure::GhostSample> found;
  std::ranges::copy_if(ran.record.ghost_samples, std::back_inserter(found), [&](const measure::GhostSample& s) {
    return s.observer == who && s.object == what && s.t_s >= from_s && s.t_s <= until_s;
  });
  return found;
}

double worst_m(const std::vector<measure::GhostSample>& views) {
  double worst = 0;
  for (const auto& s : views) worst = std::max(worst, (s.ghost.position - s.truth.position).norm());
  return worst;
}

TEST(Partition, AnUnreachablePeerIsLostAndComesBack) {
  const Ran whole = run({}), parted = run({kApart, kTogether});
  for (const char* observer : {"b", "c"}) {
    EXPECT_TRUE(views(parted, observer, "CAR", 4 + kLostAfter_s + 0.2, 7).empty()) << "nobody's: it stands still there";
    EXPECT_EQ(views(parted, observer, "CAR", 9, 15).size(), views(whole, observer, "CAR", 9, 15).size());
    // After the partition all peers are again as near to the truth as if it had not been.
    EXPECT_GT(worst_m(views(whole, observer, "CAR", 9, 15)), 0.1);
    EXPECT_LT(worst_m(views(parted, observer, "CAR", 9, 15)), 1.2 * worst_m(views(whole, observer, "CAR", 9, 15)));
  }
  EXPECT_EQ(worst_m(views(parted, "a", "CUBE_1", 9, 15)), 0.0);
  EXPECT_FALSE(views(parted, "c", "CUBE_1", 5, 7).empty()) << "b and c are on one side";
}

// A partition that is shorter than the time after which a peer is lost loses no peer, and lost updates are repeated.
TEST(Partition, AShortOneLosesNobody) {
  const Ran parted = run({kApart, "event.together={at_s = 5, kind = \"heal\"}"});
  EXPECT_EQ(views(parted, "c", "CAR", 4, 7).size(), 181u);
  EXPECT_LT(worst_m(views(parted, "c", "CAR", 6, 15)), 1.5);
}

// The cubes of two peers meet at 5.1 s: the decision is the same for all where the partition is over by then, and where
// it is not, each side has decided for itself.
TEST(Partition, DecisionsAgreeAfterwards) {
  const std::string meeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";
  const Ran early =
      testing_support::run_scenario(meeting, {"event.apart={at_s = 0.2, kind = \"partition\", groups = [[\"a\"]]}",
                                              "event.together={at_s = 2.2, kind = \"heal\"}"})
          .front();
  testing_support::expect_one_outcome(early, 1);
  for (const char* observer : {"a", "c"}) EXPECT_LT(worst_m(views(early, observer, "RIGHT", 8, 10)), 1e-6) << observer;
  for (const char* observer : {"b", "c"}) EXPECT_LT(worst_m(views(early, observer, "LEFT", 8, 10)), 1e-6) << observer;
}

TEST(Kill, WhatItRanIsNobodysOnceItIsMissed) {
  const Ran ran = run({"event.crash={at_s = 4, kind = \"kill\", peer = \"a\"}"});
  EXPECT_TRUE(views(ran, "c", "CAR", 4.01, 15).empty()) << "who is dead has no truth";
  const auto dead = std::ranges::find(ran.logs, "a", &PeerLog::name);
  ASSERT_TRUE(dead->ended_at);
  const auto watcher = std::ranges::find(ran.logs, "c", &PeerLog::name);
  const HostTime found_out = *dead->ended_at + from_seconds(kLostAfter_s + 1e-3 * kLatency_ms);
  bool believed_on = false;
  for (const PeerLog::ObjectSample& b : watcher->object_samples) {
    if (b.owner != PeerId{1}) continue;
    believed_on = believed_on || b.true_at > *dead->ended_at + std::chrono::seconds(1);
    EXPECT_LE(b.true_at, found_out);
  }
  EXPECT_TRUE(believed_on) << "until then it is dead-reckoned";
  EXPECT_EQ(worst_m(views(ran, "c", "CUBE_1", 6, 15)), 0.0) << "the others go on";
}

TEST(Leave, IsNoticedAtOnce) {
  const Ran ran = run({"event.bye={at_s = 4, kind = \"leave\", peer = \"a\"}"});
  const auto gone = std::ranges::find(ran.logs, "a", &PeerLog::name);
  const auto watcher = std::ranges::find(ran.logs, "c", &PeerLog::name);
  for (const PeerLog::ObjectSample& b : watcher->object_samples) {
    if (b.owner != PeerId{1}) continue;
    EXPECT_LE(b.true_at, *gone->ended_at + from_seconds(1e-3 * kLatency_ms + 1.0 / 60));
  }
}

TEST(Join, ReceivesEverything) {
  const Ran whole = run({}), ran = run({"event.late={at_s = 5, kind = \"join\", peer = \"c\"}"});
  EXPECT_TRUE(views(ran, "c", "CAR", 0, 5).empty());
  for (const char* object : {"CAR", "CUBE_1", "CUBE_2", "CUBE_3"}) {
    EXPECT_EQ(views(ran, "c", object, 5 + kJoining_s, 15).size(), views(whole, "c", object, 5 + kJoining_s, 15).size());
  }
  EXPECT_LT(worst_m(views(ran, "c", "CAR", 5 + kJoining_s, 15)),
            1.2 * worst_m(views(whole, "c", "CAR", 5 + kJoining_s, 15)));
  EXPECT_EQ(ran.summary["collisions"]["disagreed"], 0);
}

// The peer with the lowest id says when motions begin. A peer that joins later learns it from the remaining peers.
TEST(Join, LearnsTheStartFromWhoeverIsLeft) {
  const Ran ran = run(
      {"event.bye={at_s = 3, kind = \"leave\", peer = \"a\"}", "event.late={at_s = 6, kind = \"join\", peer = \"c\"}"});
  EXPECT_FALSE(views(ran, "c", "CUBE_1", 6 + kJoining_s, 15).empty());
}

TEST(Join, WhoWasKilledComesBackAsANewOne) {
  const Ran ran = run({"event.crash={at_s = 3, kind = \"kill\", peer = \"a\"}",
                       "event.back={at_s = 6, kind = \"join\", peer = \"a\"}"});
  EXPECT_EQ(std::ranges::count(ran.logs, "a", &PeerLog::name), 2);
  EXPECT_TRUE(views(ran, "c", "CAR", 3.01, 6).empty());
  const auto again = views(ran, "c", "CAR", 6 + kJoining_s, 15);
  EXPECT_GT(again.size(), 300u);
  EXPECT_LT(worst_m(again), 1.5) << "where the formula has it by now";
}

TEST(NetworkEvent, ChangesWhatIsSentFromThenOn) {
  const Ran slower = run({"event.slow={at_s = 7, kind = \"network\", latency_ms = 500}"});
  const Ran same = run({"event.slow={at_s = 7, kind = \"network\", latency_ms = 100}"});
  EXPECT_EQ(same.summary["objects"], run({}).summary["objects"]);
  EXPECT_EQ(worst_m(views(slower, "c", "CAR", 0, 7)), worst_m(views(same, "c", "CAR", 0, 7)));
  EXPECT_GT(worst_m(views(slower, "c", "CAR", 8, 15)), 2 * worst_m(views(same, "c", "CAR", 8, 15)));
  const Ran one_way = run({"event.slow={at_s = 7, kind = \"network\", latency_ms = 500, from = \"a\", to = \"c\"}"});
  EXPECT_EQ(worst_m(views(one_way, "b", "CUBE_1", 0, 15)), 0.0);
  EXPECT_GT(worst_m(views(one_way, "c", "CAR", 8, 15)), 1.5 * worst_m(views(one_way, "b", "CAR", 8, 15)));
}

TEST(Events, WhenAllHaveGoneTheRunIsOver) {
  const Ran ran =
      run({"event.x={at_s = 2, kind = \"leave\", peer = \"a\"}", "event.y={at_s = 2, kind = \"leave\", peer = \"b\"}",
           "event.z={at_s = 3, kind = \"kill\", peer = \"c\"}"});
  EXPECT_EQ(ran.logs.size(), 3u);
}

}  // namespace peerd::sim::simulation_test
