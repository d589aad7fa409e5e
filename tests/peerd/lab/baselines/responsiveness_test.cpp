#include "peerd/lab/baselines/responsiveness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "peerd/peer/node/peer_node.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::baselines::responsiveness_test {

using measure::GhostSample;

Vec3 way(double t_s) { return {5.0 * std::sin(t_s), 0.0, 2.0 * t_s}; }

// Six seconds at 60 Hz of what somebody shows so much later than it is.
std::vector<GhostSample> late_by(double owner_s, double observer_s) {
  std::vector<GhostSample> view;
  for (int i = 0; i < 360; ++i) {
    GhostSample s;
    s.t_s = i / 60.0;
    s.truth.position = way(s.t_s);
    s.seen.position = way(s.t_s - owner_s);
    s.shown.position = way(s.t_s - observer_s);
    view.push_back(s);
  }
  return view;
}

TEST(DelayOfAView, IsHowMuchLaterItShowsTheTruth) {
  const auto view = late_by(0.0, 0.21);
  EXPECT_NEAR(delay_s(view, Picture::kOwners).value(), 0.0, 1e-12);
  EXPECT_NEAR(delay_s(view, Picture::kObservers).value(), 0.21, 0.003);
}

TEST(DelayOfAView, OfWhatStandsIsNotKnown) {
  auto view = late_by(0.0, 0.1);
  for (GhostSample& s : view) s.truth = s.shown = Pose{};
  EXPECT_FALSE(delay_s(view, Picture::kObservers));
}

TEST(DelayOfAView, IsNotGuessedFromSamplesFarApart) {
  std::vector<GhostSample> few;
  const auto view = late_by(0.0, 0.1);
  for (std::size_t i = 0; i < view.size(); i += 6) few.push_back(view[i]);
  EXPECT_FALSE(delay_s(few, Picture::kObservers));
}

TEST(ResponseToAKey, IsWhenThePictureLeavesItsCourse) {
  std::vector<GhostSample> view;
  for (int i = 0; i < 240; ++i) {
    GhostSample s;
    s.t_s = i / 60.0;
    const auto place = [&](double turns_s) {
      return Vec3(3.0 * s.t_s, 0.0, s.t_s > turns_s ? 4.0 * (s.t_s - turns_s) : 0.0);
    };
    s.seen.position = place(1.0);
    s.shown.position = place(1.3);
    view.push_back(s);
  }
  EXPECT_NEAR(response_s(view, Picture::kOwners, 1.0).value(), 1.0 / 60.0, 1e-9);
  EXPECT_NEAR(response_s(view, Picture::kObservers, 1.0).value(), 0.3 + 1.0 / 60.0, 0.02);
  EXPECT_FALSE(response_s(view, Picture::kObservers, 0.0)) << "there is nothing before it";
  EXPECT_FALSE(response_s(view, Picture::kOwners, 2.0)) << "it goes on";
}

TEST(MovesByKeys, AreThoseOfWhatTheirPeerOwns) {
  const config::Scenario scenario = sim::testing_support::scenario_of(PEERD_SOURCE_DIR "/configs/scenarios/keys.toml");
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  const auto objects = must(config::resolve(scenario.runs.front(), shared->world.scene));
  const auto moves = key_moves(scenario.runs.front(), objects, shared->world.scene);
  ASSERT_FALSE(moves.empty());
  EXPECT_EQ(moves.front().at_s, 1.5);
  EXPECT_EQ(shared->world.scene.path_of(moves.front().object), "RED");
}

}  // namespace peerd::baselines::responsiveness_test
