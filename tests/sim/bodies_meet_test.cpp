// Two objects of two peers meet: the peer with the lower id decides, and all three peers hold one outcome.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::bodies_meet_test {

using testing_support::Ran;
using testing_support::run_scenario;

const std::string kMeeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";

// The state that a peer held of an object at the end, as its log says.
KinematicState last_word(const Ran& ran, const std::string& peer, const std::string& path) {
  const auto object = std::ranges::find(ran.record.objects, path, &measure::ObjectInfo::path)->object;
  for (const PeerLog& log : ran.logs) {
    if (log.name != peer) continue;
    for (auto b = log.object_samples.rbegin(); b != log.object_samples.rend(); ++b) {
      if (b->object == object) return b->state;
    }
  }
  throw std::runtime_error(peer + " has no belief of " + path);
}

struct Meeting {
  const char* name;
  std::vector<std::string> sets;
  const char* decider;
};
class BodiesMeet : public testing::TestWithParam<Meeting> {};
INSTANTIATE_TEST_SUITE_P(
    Ways, BodiesMeet,
    testing::Values(Meeting{"ColliderDecides", {}, "a"}, Meeting{"CollideeDecides", {"peer.a.id=7"}, "b"},
                    Meeting{"WithoutPrediction", {"replication.approach=dr"}, "a"},
                    Meeting{"WithTracking", {"replication.approach=dr+rcp+acpt"}, "a"},
                    Meeting{"FirstOrder", {"replication.order=1"}, "a"},
                    Meeting{"OtherTickRates", {"peer.a.tick_hz=144", "peer.b.tick_hz=30"}, "a"},
                    Meeting{"ClocksApart", {"peer.a.clock_offset_s=3", "peer.b.clock_offset_s=-3"}, "a"},
                    Meeting{"LossyNetwork", {"network.loss=0.1", "network.jitter_ms=30", "seed=3"}, "a"},
                    Meeting{"SlowNetwork", {"network.latency_ms=400"}, "a"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_P(BodiesMeet, OnePeerDecidesAndAllHoldOneOutcome) {
  const Ran ran = run_scenario(kMeeting, GetParam().sets).front();
  const measure::ContactRow* decided = nullptr;
  std::size_t applied = 0;
  for (const auto& c : ran.record.contacts) {
    const std::string peer = std::ranges::find(ran.record.peers, c.peer, &measure::PeerInfo::peer)->name;
    EXPECT_NE(c.kind, "owner") << "neither body is one peer's own business";
    if (c.kind == "decided") {
      EXPECT_EQ(decided, nullptr) << "decided twice";
      EXPECT_EQ(peer, GetParam().decider);
      decided = &c;
    }
  }
  ASSERT_NE(decided, nullptr);
  for (const auto& c : ran.record.contacts) {
    if (c.kind != "applied") continue;
    ++applied;
    EXPECT_NEAR(c.t_s, decided->t_s, 1e-9) << "at the very contact time";
    EXPECT_LT((c.normal - decided->normal).norm(), 1e-6);
  }
  EXPECT_EQ(applied, 2u) << "each other peer once, however many copies came";
  EXPECT_EQ(ran.summary["collisions"]["disagreed"], 0);
  EXPECT_EQ(ran.summary["collisions"]["missed"], 0);

  // Both answer, each by its own response: LEFT's velocity is mirrored, RIGHT stops where it was hit.
  const KinematicState left = last_word(ran, "a", "LEFT"), right = last_word(ran, "b", "RIGHT");
  EXPECT_LT((left.velocity - Vec3(-2, 0, 0)).norm(), 1e-6);
  EXPECT_TRUE(right.velocity.isZero(1e-9));
  for (const char* peer : {"a", "b", "c"}) {
    SCOPED_TRACE(peer);
    const KinematicState l = last_word(ran, peer, "LEFT"), r = last_word(ran, peer, "RIGHT");
    EXPECT_LT((l.velocity - left.velocity).norm(), 1e-5);
    EXPECT_LT((r.position - right.position).norm(), 1e-5);
    EXPECT_TRUE(r.velocity.isZero(1e-9));
  }
}

// A peer's log goes by its own ticks, so positions of a moving body are compared through the report, at one true time.
TEST_P(BodiesMeet, NoGhostIsWrongForLongerThanTheLatency) {
  const Ran ran = run_scenario(kMeeting, GetParam().sets).front();
  const auto decided = std::ranges::find(ran.record.contacts, "decided", &measure::ContactRow::kind);
  ASSERT_NE(decided, ran.record.contacts.end());
  const double news_s = decided->t_s + 1e-3 * ran.settings.network.latency_ms + 0.25;
  std::size_t late_samples = 0;
  for (const auto& s : ran.record.ghost_samples) {
    const double error_m = (s.truth.position - s.ghost.position).norm();
    if (s.t_s > news_s) {
      EXPECT_LT(error_m, 0.15) << "at " << s.t_s
                               << " s";  // 4 m/s on clocks that agree to some milliseconds, and jitter
      ++late_samples;
    }
  }
  EXPECT_GT(late_samples, 50u);
}

// An object that begins to move at t = 0 is known as soon as possible: one latency and one tick later, whichever peer
// has started first.
TEST(BodiesMeetBefore, EveryoneKnowsWhatMovesFromTheStart) {
  for (const char* latency_ms : {"0", "1", "5", "40", "300"}) {
    for (const char* first : {"peer.a.id=1", "peer.a.id=9"}) {
      SCOPED_TRACE(testing::Message() << latency_ms << " ms, " << first);
      const Ran ran =
          run_scenario(kMeeting, {std::string("network.latency_ms=") + latency_ms, first, "duration_s=2"}).front();
      for (const auto& [observer, path] : {std::pair{"a", "RIGHT"}, {"b", "LEFT"}, {"c", "LEFT"}, {"c", "RIGHT"}}) {
        const double speed = path == std::string("LEFT") ? 2.0 : 1.0;
        const double unknown_s = 1e-3 * std::stod(latency_ms) + 1.01 / 60;
        EXPECT_LE(ran.view(observer, path)["ghost_error_m"]["max"].get<double>(), speed * unknown_s)
            << observer << " of " << path;
        EXPECT_EQ(ran.record.ghost_samples.back().truth.position, ran.record.ghost_samples.back().ghost.position);
      }
    }
  }
}

// The observers predict the outcome before its news: without prediction, ghosts continue until they receive it.
TEST(BodiesMeetPrediction, SparesTheObserverTheLatency) {
  const Ran dr = run_scenario(kMeeting, {"replication.approach=dr", "network.latency_ms=400"}).front();
  const Ran rcp = run_scenario(kMeeting, {"replication.approach=dr+rcp", "network.latency_ms=400"}).front();
  const auto worst_m = [](const Ran& ran) {  // error of LEFT at c, once c knows the start
    const ObjectId left = std::ranges::find(ran.record.objects, "LEFT", &measure::ObjectInfo::path)->object;
    double worst = 0.0;
    for (const auto& s : ran.record.ghost_samples) {
      if (s.observer == PeerId{3} && s.object == left && s.t_s > 1.0)
        worst = std::max(worst, (s.truth.position - s.ghost.position).norm());
    }
    return worst;
  };
  EXPECT_GT(worst_m(dr), 1.5) << "6 m/s for 0.4 s";
  EXPECT_LT(worst_m(rcp), 0.1);
}

}  // namespace peerd::sim::bodies_meet_test
