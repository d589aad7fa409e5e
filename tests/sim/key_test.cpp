// Keys pressed at one peer move its objects, and the other peers see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::key_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::Ran;
using testing_support::run_scenario;

const std::string kKeys = PEERD_SOURCE_DIR "/configs/scenarios/keys.toml";
constexpr double kLatency_s = 0.1, kTick_s = 1.0 / 60;

// The state of an object at its owner, or as another peer believed it, in time of the scenario.
std::vector<std::pair<double, KinematicState>> states(const Ran& ran, std::size_t peer, const std::string& path) {
  const PeerLog& log = ran.logs.at(peer);
  const auto known = std::ranges::find(ran.record.objects, path, &measure::ObjectInfo::path);
  if (known == ran.record.objects.end()) throw std::runtime_error("nobody runs " + path);
  const ObjectId object = known->object;
  std::vector<std::pair<double, KinematicState>> rows;
  for (const PeerLog::ObjectSample& b : log.object_samples) {
    if (b.object == object) rows.emplace_back(to_seconds(b.at - *log.start), b.state);
  }
  EXPECT_GT(rows.size(), 300u) << path;
  return rows;
}
KinematicState at(const std::vector<std::pair<double, KinematicState>>& rows, double t_s) {
  return std::ranges::min_element(rows, {}, [&](const auto& row) { return std::abs(row.first - t_s); })->second;
}

std::vector<std::string> key_lines(const std::vector<std::string>& sets) {
  const auto scenario = testing_support::scenario_of(kKeys, sets);
  const auto shared = must(share_world(scenario.world));
  std::vector<std::string> lines;
  const auto note = [&](HostTime, const PeerNode& node, const LogLine& line, bool) {
    lines.push_back(node.name() + ": " + line.text);
  };
  (void)must(simulate(scenario.runs.front(), *shared, {}, note));
  return lines;
}

TEST(Keys, SetACarInMotionAndTheOtherPeerFollows) {
  const Ran ran = run_scenario(kKeys).front();
  const auto truth = states(ran, 0, "RED"), ghost = states(ran, 1, "RED");
  // At rest, 2 m/s from 1.5 s on, 7 m/s from 3 s on, at rest from 4.5 s on: 3 m and 10.5 m along -z.
  EXPECT_EQ(at(truth, 1.4).velocity, Vec3::Zero());
  EXPECT_EQ(at(truth, 2.0).velocity, Vec3(0, 0, -2));
  EXPECT_EQ(at(truth, 4.0).velocity, Vec3(0, 0, -7));
  EXPECT_EQ(at(truth, 5.0).velocity, Vec3::Zero());
  EXPECT_NEAR(at(truth, 3.0).position.z(), -3.0, 2 * kTick_s * 2);
  EXPECT_NEAR(at(truth, 6.0).position.z(), -13.5, 1e-3);
  EXPECT_EQ(at(truth, 6.0).position.x(), -4.0);

  constexpr double kThreshold_m = 0.25;
  double worst_m = 0;
  for (const auto& [t_s, state] : ghost) {
    const double speed = t_s < 3 ? 2 : 7;  // speed that the other peer does not know yet
    const double error_m = (state.position - at(truth, t_s).position).norm();
    EXPECT_LT(error_m, kThreshold_m + speed * (kLatency_s + 2 * kTick_s)) << t_s;
    worst_m = std::max(worst_m, error_m);
  }
  EXPECT_GT(worst_m, 0.1) << "the latency is there to be seen";
  for (const double t_s : {2.9, 4.4, 5.9}) {
    EXPECT_NEAR((at(ghost, t_s).position - at(truth, t_s).position).norm(), 0, 0.15) << t_s;
    EXPECT_EQ(at(ghost, t_s).velocity, at(truth, t_s).velocity) << t_s;
  }
  EXPECT_EQ(ran.summary["counters"]["keys"], 5);
  EXPECT_EQ(ran.summary["counters"]["key_changes"], 5);
  EXPECT_EQ(ran.summary["counters"]["key_changes_refused"], 0);
  EXPECT_LE(ran.updates("RED"), 8u) << "a key costs an update, nothing else does";
}

TEST(Keys, AsEventsAreTheSame) {
  const std::vector<std::string> events{
      R"(event.k1={at_s = 1.5, kind = "key", peer = "a", key = "ArrowUp"})",
      R"(event.k2={at_s = 2, kind = "key", peer = "b", key = "w"})",
      R"(event.k3={at_s = 2.5, kind = "key", peer = "b", value = 87})",
      R"(event.k4={at_s = 3, kind = "key", peer = "a", key = "ArrowUp", shift = true})",
      R"(event.k5={at_s = 4.5, kind = "key", peer = "a", key = " "})"};
  std::vector<std::string> sets = events;
  sets.insert(sets.end(), {"peer.a.key=[]", "peer.b.key=[]"});
  EXPECT_EQ(key_lines(sets), key_lines({}));
  EXPECT_EQ(run_scenario(kKeys, sets).front().summary["objects"], run_scenario(kKeys).front().summary["objects"]);
}

TEST(Keys, AsAnEventNeedsItsPeerInTheSession) {
  const std::vector<std::string> late{R"(event.come={at_s = 1, kind = "join", peer = "b"})", "peer.a.key=[]",
                                      "peer.b.key=[]",
                                      R"(event.early={at_s = 1.1, kind = "key", peer = "b", key = "w"})",
                                      R"(event.later={at_s = 5, kind = "key", peer = "b", key = "w"})"};
  EXPECT_EQ(key_lines(late).size(), 1u) << "joining takes two seconds";
}

TEST(Keys, AValueIsInTheFrameOfTheRecipientsParent) {
  const Ran ran = run_scenario(kKeys).front();
  for (const std::size_t peer : {0u, 1u}) {
    const Vec3 v = at(states(ran, peer, "RAMP/BLUE"), 4.0).velocity;
    EXPECT_NEAR(v.x(), 0, 1e-12);
    EXPECT_NEAR(v.y(), 2 * std::sin(0.1), 1e-6) << "two presses, up the ramp";
    EXPECT_NEAR(v.z(), -2 * std::cos(0.1), 1e-6);
  }
}

TEST(Keys, TheSameRunGivesTheSameBits) {
  const auto beliefs = [] {
    const Ran ran = run_scenario(kKeys, {"network.jitter_ms=20", "network.loss=0.1"}).front();
    std::vector<double> z;
    for (const PeerLog& log : ran.logs) {
      for (const auto& b : log.object_samples) z.push_back(b.state.position.z());
    }
    return z;
  };
  EXPECT_EQ(beliefs(), beliefs());
}

TEST(Keys, ABrakeTakesThePedalsAwayUntilItIsReleased) {
  const std::vector<std::string> lines =
      key_lines({R"(peer.a.key=[{at_s = 1, key = "ArrowUp"}, {at_s = 2, key = "b"}, {at_s = 2.5, key = "ArrowUp"},
                      {at_s = 3, key = "B"}, {at_s = 3.5, key = "ArrowUp"}])",
                 "peer.b.key=[]"});
  EXPECT_THAT(lines, ElementsAre("a: ArrowUp: FASTER changes the velocity of RED by (0, 0, -2) m/s",
                                 "a: B: BRAKE sets the velocity of RED to (0, 0, 0) m/s",
                                 "a: ArrowUp: no enabled KeySensor listens to it", "a: B: 1 KeySensors got it",
                                 "a: ArrowUp: FASTER changes the velocity of RED by (0, 0, -2) m/s"));
}

TEST(Keys, ForAnotherPeersCarAreRefusedAndSaySo) {
  const std::vector<std::string> lines =
      key_lines({R"(peer.a.key=[{at_s = 1, key = "w"}])", R"(peer.b.key=[{at_s = 1, value = 32}])"});
  EXPECT_THAT(lines, ElementsAre("a: W: UPHILL does not move RAMP/BLUE: peer b (id 2) runs it",
                                 "b: \" \": STOP does not move RED: peer a (id 1) runs it"));
}

TEST(Keys, OfACarThatAFormulaMovesAreRefused) {
  const std::vector<std::string> lines =
      key_lines({"peer.a.motion.RED.x=t", R"(peer.a.key=[{at_s = 1, key = "ArrowUp"}])", "peer.b.key=[]"});
  EXPECT_THAT(lines, ElementsAre("a: ArrowUp: FASTER does not move RED: a motion of the configuration moves it"));
}

TEST(Keys, OfACarThatNobodyRunsAreRefused) {
  const std::vector<std::string> lines =
      key_lines({"peer.a.owns=[]", R"(peer.a.key=[{at_s = 1, key = "ArrowUp"}])", "peer.b.key=[]"});
  EXPECT_THAT(lines, ElementsAre("a: ArrowUp: FASTER does not move RED: no peer runs it"));
}

}  // namespace peerd::sim::key_test
