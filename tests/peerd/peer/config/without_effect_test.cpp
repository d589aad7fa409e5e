#include "peerd/peer/config/without_effect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/must.hpp"
#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::without_effect_test {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kPeers = "world = \"w.wrl\"\n[peer.a]\nid = 1\n[peer.b]\nid = 2\n";

class WithoutEffectTest : public testing_support::ScenarioText {
 protected:
  std::vector<std::string> warnings(const std::string& text, std::vector<std::string> sets = {}) {
    return read(text, std::move(sets)).warnings;
  }
};

// A key that another one switches off, and settings with which it counts.
struct Case {
  const char* name;
  const char* key;  // KEY=VALUE
  const char* why;
  std::vector<std::string> with;
  std::vector<std::string> around = {};
};
class SwitchedOff : public WithoutEffectTest, public testing::WithParamInterface<Case> {};
TEST_P(SwitchedOff, IsNamedWhereItHasNoEffect) {
  const Case& c = GetParam();
  std::vector<std::string> sets = c.around;
  sets.emplace_back(c.key);
  const std::string key = std::string(c.key).substr(0, std::string(c.key).find('='));
  EXPECT_THAT(warnings(kPeers, sets), ElementsAre("warning: --set " + key + " has no effect: " + c.why));
  sets = c.with;
  sets.emplace_back(c.key);
  EXPECT_THAT(warnings(kPeers, sets), IsEmpty());
}
const char* const kNoRegions = "regions.cell_m is 0";
const char* const kNoModels = "replication.model is not best";
const char* const kNoBudget = "replication.wanted_error_m is 0";
const char* const kNoProximity = "replication.approach is not dr+rcp+acpt";
const char* const kDoesNotSkip = "the peer does not skip_unseen";
const char* const kComputesAll = "the server of decisions, and who shows the past, computes all of it";
const char* const kBounded = "the bounded latency delays all objects alike";
INSTANTIATE_TEST_SUITE_P(
    Table, SwitchedOff,
    testing::Values(
        Case{"Far", "peer.a.viewpoint.far_m=9", kDoesNotSkip, {"peer.a.skip_unseen=true"}},
        Case{"SkippingServer",
             "peer.a.skip_unseen=true",
             kComputesAll,
             {"decisions.policy=server", "decisions.server=b"},
             {"decisions.policy=server", "decisions.server=a"}},
        Case{"SkippingInThePast", "peer.a.skip_unseen=true", kComputesAll, {}, {"replication.display_delay_ms=100"}},
        Case{"Restamps", "relay.restamps=true", "there is no relay.through", {"relay.through=a"}},
        Case{"Server", "decisions.server=a", "decisions.policy is not server", {"decisions.policy=server"}},
        Case{"Memory", "replication.model_memory_s=1", kNoModels, {"replication.model=best"}},
        Case{"Models", "replication.models=[\"first\"]", kNoModels, {"replication.model=best"}},
        Case{"Horizon", "replication.model_horizon_s=1", kNoModels, {"replication.model=best"}},
        Case{"Budget", "replication.updates_per_s=3", kNoBudget, {"replication.wanted_error_m=0.1"}},
        Case{"Saved", "replication.updates_saved=3", kNoBudget, {"replication.wanted_error_m=0.1"}},
        Case{"Close", "replication.close_threshold_m=0.1", kNoProximity, {}, {"replication.approach=dr"}},
        Case{"CloseInSnapshots",
             "replication.close_threshold_m=0.1",
             kNoProximity,
             {"replication.approach=dr", "replication.snapshots_hz=20"},
             {"replication.approach=dr+rcp"}},
        Case{"CloseFor", "replication.close_proximity_s=1", kNoProximity, {}, {"replication.approach=dr+rcp"}},
        Case{"Proximity", "replication.proximity=surfaces", kNoProximity, {}, {"replication.approach=dr"}},
        Case{"Tightening", "replication.tightening=by-time", kNoProximity, {}, {"replication.approach=dr"}},
        Case{"Convergence",
             "replication.convergence_s=1",
             "replication.convergence is jump",
             {"replication.convergence=cubic"}},
        Case{"OwnDelay",
             "replication.delay_own=true",
             "nothing delays what is displayed",
             {"replication.display_delay_ms=100"}},
        Case{"OwnDelayMeasured",
             "replication.delay_own=true",
             "nothing delays what is displayed",
             {"replication.display_delay_measured=true"}},
        Case{"OwnDelayBounded",
             "replication.delay_own=true",
             kBounded,
             {"replication.display_delay_ms=100"},
             {"replication.bounded_latency_ms=100"}},
        Case{"DelayBounded",
             "replication.display_delay_ms=100",
             kBounded,
             {},
             {"replication.bounded_latency_measured=true"}},
        Case{"MeasuredDelayBounded",
             "replication.display_delay_measured=true",
             kBounded,
             {},
             {"replication.bounded_latency_ms=100"}},
        Case{"ConvergenceBounded",
             "replication.convergence=cubic",
             "the bounded latency shows updates as they are",
             {},
             {"replication.bounded_latency_ms=100"}},
        Case{"ConvergenceTimeBounded",
             "replication.convergence_s=1",
             "the bounded latency shows updates as they are",
             {"replication.convergence=cubic"},
             {"replication.bounded_latency_ms=100"}},
        Case{"SkippingWithABound", "peer.a.skip_unseen=true", kComputesAll, {}, {"replication.bounded_latency_ms=100"}},
        Case{"Resting",
             "replication.resting_time_threshold_s=9",
             "it does not count with regions, nor with a relay",
             {},
             {"regions.cell_m=10"}},
        Case{"Margin", "regions.margin_m=5", kNoRegions, {"regions.cell_m=10"}},
        Case{"Counts", "regions.counts=[2, 1, 2]", kNoRegions, {"regions.cell_m=10"}},
        Case{"Stay", "regions.stay_s=5", kNoRegions, {"regions.cell_m=10"}},
        Case{"Lookahead", "regions.lookahead_s=5", kNoRegions, {"regions.cell_m=10"}},
        Case{"Fastest", "regions.fastest_m_s=5", kNoRegions, {"regions.cell_m=10"}},
        Case{"Burst", "network.loss_burst=5", "no link has a loss", {"network.link.a.b.loss=0.1"}},
        Case{"BurstOfAnEvent",
             "network.loss_burst=5",
             "no link has a loss",
             {"event.e={at_s = 1, kind = \"network\", loss = 0.1}"}},
        Case{"Reordering", "network.reordering=0.1", "no link delays anything", {"network.jitter_ms=5"}},
        Case{"Peers",
             "transport.peers=[\"192.0.2.7:47474\"]",
             "transport.multicast is always",
             {},
             {"transport.multicast=always"}},
        Case{"Ttl", "transport.ttl=4", "transport.multicast is never", {}, {"transport.multicast=never"}},
        Case{"Feed", "peer.a.feed.stale_s=1", "no motion of the peer has outside = true", {"motion.CAR.outside=true"}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(WithoutEffectTest, TheWarningSaysWhere) {
  EXPECT_THAT(warnings(kPeers + "[relay]\nrestamps = true\n"),
              ElementsAre(EndsWith("my.toml:7:12: warning: relay.restamps has no effect: there is no relay.through")));
}

TEST_F(WithoutEffectTest, WhatIsOffAnywayIsNotNamed) {
  EXPECT_THAT(warnings(kPeers + "[relay]\nrestamps = false\n[replication]\ndelay_own = false\n"), IsEmpty());
}

TEST_F(WithoutEffectTest, AnEffectInOneRunOfASweepIsOne) {
  const std::string text = kPeers + "[decisions]\nserver = \"a\"\n[sweep]\n\"decisions.policy\" = [\"id\", ";
  EXPECT_THAT(warnings(text + "\"server\"]\n"), IsEmpty());
  EXPECT_THAT(warnings(text + "\"velocity\"]\n"), ElementsAre(HasSubstr("decisions.server has no effect")));
  request.sweep = false;
  EXPECT_THAT(warnings(text + "\"server\"]\n"), IsEmpty()) << "a peer runs one value of them";
}

TEST_F(WithoutEffectTest, WhoLaysTheSwitchOverAScenarioMeansIt) {
  const std::string text = kPeers + "[replication]\nclose_threshold_m = 0.1\n";
  EXPECT_THAT(warnings(text, {"replication.approach=dr"}), IsEmpty());
  EXPECT_THAT(warnings(text, {"replication.approach=[\"dr\", \"dr+rcp\"]"}), IsEmpty());
  EXPECT_THAT(warnings(text + "approach = \"dr\"\n"), ElementsAre(HasSubstr("my.toml:7:21: warning: ")));
  request.configs = {folder.write("over.toml", "[relay]\nrestamps = true\n")};
  EXPECT_THAT(warnings(kPeers), ElementsAre(HasSubstr("over.toml:2:12: warning: relay.restamps has no effect")));
}

// A peer that joins a unicast session gets its transport.ttl from the other peers.
TEST_F(WithoutEffectTest, WhatOtherPeersHaveSetIsNotNamed) {
  const std::string provided = "[transport]\nmulticast = \"never\"\nttl = 1\n";
  EXPECT_THAT(warnings(kPeers + provided), ElementsAre(HasSubstr("warning: transport.ttl has no effect")));
  request.text = provided;
  const std::vector<std::string> self = {"world=w.wrl", "peer.me.id=77"};
  EXPECT_THAT(warnings("", self), IsEmpty());
  std::vector<std::string> with_ttl = self;
  with_ttl.emplace_back("transport.ttl=3");
  EXPECT_THAT(warnings("", with_ttl), ElementsAre(HasSubstr("warning: --set transport.ttl has no effect")));
}

TEST_F(WithoutEffectTest, NoShippedScenarioHasSuchAKey) {
  for (const auto& file : std::filesystem::directory_iterator(PEERD_SOURCE_DIR "/configs/scenarios")) {
    request.file = file.path();
    EXPECT_THAT(must(read_scenario(request)).warnings, IsEmpty()) << file.path();
    ScenarioRequest with_best = request;
    with_best.configs = {PEERD_SOURCE_DIR "/configs/best.toml"};
    EXPECT_THAT(read_scenario(with_best)->warnings, IsEmpty()) << file.path();
  }
}

TEST_F(WithoutEffectTest, MoreViewsMatterToWhoSkipsAlone) {
  EXPECT_THAT(warnings(kPeers + "[[peer.b.view]]\n"),
              ElementsAre(EndsWith("warning: peer.b.view has no effect: the peer does not skip_unseen")));
  EXPECT_THAT(warnings(kPeers + "skip_unseen = true\n[[peer.b.view]]\n"), IsEmpty());
}

}  // namespace peerd::config::without_effect_test
