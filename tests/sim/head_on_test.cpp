// configs/scenarios/head-on.toml: every policy of decision, on good and bad networks.
#include <gtest/gtest.h>

#include <map>

#include "peerd/lab/measure/wrong_outcomes.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::head_on_test {

using testing_support::Ran;
using testing_support::run_scenario;

const std::string kHeadOn = PEERD_SOURCE_DIR "/configs/scenarios/head-on.toml";

class HeadOn : public testing::TestWithParam<int> {};  // seeds
TEST_P(HeadOn, OneOutcomeEverywhereAndExpectedErrorIsBest) {
  std::map<std::string, std::uint64_t> wrong;
  for (const Ran& ran : run_scenario(kHeadOn, {"seed=" + std::to_string(GetParam()), "network.loss=0.05"})) {
    SCOPED_TRACE(ran.settings.params.dump());
    const auto& collisions = ran.summary["collisions"];
    EXPECT_GE(collisions["decided"], 10);
    EXPECT_EQ(collisions["agreed"], 2 * collisions["decided"].get<int>());
    EXPECT_EQ(collisions["disagreed"], 0);
    EXPECT_EQ(collisions["missed"], 0);
    const measure::WrongOutcomes& w = ran.record.wrong.value();
    EXPECT_EQ(w.truth, 15u);
    wrong[ran.settings.params["decisions.policy"].get<std::string>()] += w.missing + w.spurious;
  }
  ASSERT_EQ(wrong.size(), 5u);
  for (const auto& [policy, count] : wrong) EXPECT_LE(wrong["expected-error"], count) << policy;
  EXPECT_LT(wrong["expected-error"], wrong["id"]);
  EXPECT_LT(wrong["expected-error"], wrong["velocity"]);
}
INSTANTIATE_TEST_SUITE_P(Seeds, HeadOn, testing::Values(1, 2, 3));

// A viewpoint that moves with an object of its peer: RIGHT's owner looks where RIGHT goes, so at LEFT, and decides.
TEST(HeadOnView, TheViewingPeerDecides) {
  const std::string meeting = PEERD_SOURCE_DIR "/tests/sim/worlds/meeting.toml";
  for (const auto& [angle_deg, decider] : {std::pair{"90", 2u}, {"-90", 1u}}) {
    const Ran ran = run_scenario(meeting, {"decisions.policy=field-of-view", "peer.b.viewpoint.object=RIGHT",
                                           std::string("peer.b.viewpoint.angle_deg=") + angle_deg,
                                           "peer.b.viewpoint.position=[0, 0, 0]"})
                        .front();
    EXPECT_EQ(ran.contacts(PeerId{decider}, "decided").size(), 1u) << angle_deg;
    EXPECT_EQ(ran.contacts(PeerId{3 - decider}, "applied").size(), 1u) << angle_deg;
  }
}

}  // namespace peerd::sim::head_on_test
