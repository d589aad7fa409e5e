#include "peerd/peer/config/shared_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/peer/config/scenario.hpp"
#include "tests/must.hpp"

namespace peerd::config::shared_settings_test {

using testing::HasSubstr;
using testing::Not;

RunSettings run_of(const std::string& text, std::vector<std::string> sets = {}) {
  return must(read_scenario({.sets = std::move(sets), .real = true, .sweep = false, .text = text})).runs.front();
}

// A joining peer that adds its world and itself has the same session.
TEST(SharedSettings, MakeTheSameSessionElsewhere) {
  const RunSettings run = run_of(R"toml(world = "town.wrl"
world_name = "Town of 'quotes' and \"more\""
duration_s = 3
[replication]
error_threshold_m = 0.05
tick_hz = 30
[decisions]
policy = "server"
server = "boss"
[regions]
cell_m = 25.0
[collision]
engine = "obb"
[transport]
group = "239.192.90.0"
group_pool = 16
port = 5000
interface = "eth7"
[motion.CAR]
x = "t"
[peer.boss]
id = 1
owns = ["CAR"]
[peer.other]
id = 2
)toml");
  const std::string shared = shared_settings(run);
  const RunSettings joining_peer = run_of(shared, {"world=w.wrl", "peer.me.id=77"});
  EXPECT_EQ(joining_peer.replication.tick_hz, 30u);
  EXPECT_EQ(joining_peer.replication.bounded_latency.tick_hz, 30u);
  EXPECT_EQ(joining_peer.replication.policy.error_threshold_m, 0.05);
  EXPECT_EQ(joining_peer.replication.decisions.policy, replication::DecisionPolicy::kServer);
  EXPECT_EQ(joining_peer.replication.decisions.server, PeerId{1});
  EXPECT_EQ(joining_peer.replication.session_hash(5), run.replication.session_hash(5));
  EXPECT_EQ(joining_peer.replication.collision.engine, "obb");
  EXPECT_EQ(joining_peer.transport.group, "239.192.90.0");
  EXPECT_EQ(joining_peer.transport.group_pool, 16u);
  EXPECT_EQ(joining_peer.transport.port, 5000u);
  EXPECT_EQ(joining_peer.transport.interface, "") << "that is each peer's own";
  EXPECT_THAT(shared, Not(HasSubstr("other")));
  EXPECT_THAT(shared, Not(HasSubstr("CAR")));
  EXPECT_THAT(shared, HasSubstr("Town of"));
}

TEST(SharedSettings, OfAPeerWithoutAConfigurationAreTheDefaults) {
  const RunSettings run = run_of("", {"world=w.wrl", "peer.peer.id=5"});
  const RunSettings joining_peer = run_of(shared_settings(run), {"world=w.wrl", "peer.peer.id=6"});
  EXPECT_EQ(joining_peer.peers.size(), 1u);
  EXPECT_FALSE(joining_peer.transport.port);
  EXPECT_EQ(joining_peer.transport.group, run.transport.group);
}

TEST(SharedSettings, AreNothingMore) {
  EXPECT_TRUE(check_shared(""));
  EXPECT_TRUE(check_shared(shared_settings(run_of("", {"world=w.wrl", "peer.peer.id=5", "transport.port=5000"}))));
  for (const char* const bad :
       {"[event.x]\npeer = \"peer\"\nkind = \"add\"\nfile = \"/etc/passwd\"\n", "world = \"w.wrl\"\n",
        "[peer.peer]\nid = 1\n[peer.peer.feed]\nudp = \"0.0.0.0:1\"\n", "[transport]\ninterface = \"eth0\"\n",
        "[control]\nsocket = \"/x\"\n", "peer = 1\n", "transport = 1\n", "[motion.CAR]\nx = \"t\"\n", "no TOML"}) {
    EXPECT_FALSE(check_shared(bad)) << bad;
  }
}

}  // namespace peerd::config::shared_settings_test
