// The real program where multicast is missing: peers in network namespaces of their own, on interfaces without it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/live/assemble.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/net/wire.hpp"

namespace peerd::unicast_process_test {

using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;
using testing_support::ScratchFolder;

using Words = std::vector<std::string>;

const std::string kScenario = std::string(PEERD_SOURCE_DIR) + "/configs/scenarios/eq47.toml";
const Words kSettings{"duration_s=4", "replication.approach=dr+rcp+acpt", "replication.order=2"};

class UnicastProcess : public testing::Test {
 protected:
  // Starts a peer in the namespace of the calling thread.
  Process start(const std::string& name, const char* interface, unsigned slot, const std::string& seeds,
                const Words& more = {}) {
    Words words{"run",     "--config", kScenario,
                "--peer",  name,       "--interface",
                interface, "--port",   std::to_string(own_port(slot)),
                "--once",  "--record", record_of(name)};
    for (const std::string& s : kSettings) words.insert(words.end(), {"--set", s});
    words.insert(words.end(), {"--set", "transport.peers=[" + seeds + "]"});
    words.insert(words.end(), more.begin(), more.end());
    return Process(folder, name, PEERD_PROGRAM, std::move(words));
  }
  [[nodiscard]] static std::string seed(const char* host, unsigned slot) {
    return "\"" + std::string(host) + ":" + std::to_string(own_port(slot)) + "\"";
  }
  [[nodiscard]] std::string record_of(const std::string& name) const { return (folder / (name + ".rows")).string(); }
  // The summary of all peers' logs.
  nlohmann::ordered_json summary() {
    const auto scenario = config::read_scenario(
        {.file = kScenario, .configs = {}, .sets = kSettings, .seed = {}, .real = true, .sweep = true});
    if (!scenario) throw std::runtime_error(scenario.error().text);
    const auto shared = share_world(scenario->world);
    std::vector<PeerLog> logs;
    for (const char* name : {"a", "b", "c"}) {
      auto log = load_peer_log(record_of(name));
      if (!log) throw std::runtime_error(log.error().text);
      logs.push_back(std::move(*log));
    }
    auto record = assemble(scenario->runs.front(), **shared, logs);
    if (!record) throw std::runtime_error(record.error().text);
    return measure::summarise({"eq47", "real", 1, {}}, {&*record, 1})["runs"][0];
  }
  void expect_shared_world(std::initializer_list<Process*> peers, const std::string& why) {
    for (Process* p : peers) {
      EXPECT_EQ(p->exit_code(20), 0) << p->out() << p->err();
      EXPECT_THAT(p->out(), AllOf(HasSubstr("no multicast: " + why), HasSubstr("in session"),
                                  HasSubstr("leaving: the scenario is over"), Not(HasSubstr("undecodable")),
                                  Not(HasSubstr("net.in_malformed"))));
    }
    const auto report = summary();
    for (const auto& o : report["objects"]) {
      if (o["path"] != "CAR") continue;
      EXPECT_GT(o["samples"].get<int>(), 100);
      EXPECT_LT(o["ghost_error_m"]["mean"].get<double>(), 0.2) << o["observer"];
    }
    EXPECT_TRUE(report["state_roots_equal"]);
  }

  ScratchFolder folder;
};

// Peers a and c are on one computer and b on another; only a is configured, so b and c learn of each other through a.
TEST_F(UnicastProcess, ThreeShareEq47WhereTheInterfacesDoNoMulticast) {
  with_wire([&](const Wire& wire) {
    wire.right.enter();
    ASSERT_TRUE(shell("ip link set vb multicast off"));
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va multicast off"));
    const std::string seeds = seed("192.0.2.1", 0);
    Process a = start("a", "va", 0, seeds), c = start("c", "va", 1, seeds);
    wire.right.enter();
    Process b = start("b", "vb", 0, seeds);
    expect_shared_world({&a, &b, &c}, "interface \"v");
  });
}

TEST_F(UnicastProcess, OverIpv6Too) {
  with_wire([&](const Wire& wire) {
    wire.right.enter();
    ASSERT_TRUE(shell("ip addr add 2001:db8::2/64 dev vb nodad"));
    wire.left.enter();
    ASSERT_TRUE(shell("ip addr add 2001:db8::1/64 dev va nodad"));
    const Words more{"--group", "ff15::50:0", "--set", "transport.multicast=never"};
    const std::string seeds = seed("[2001:db8::1]", 2);
    Process a = start("a", "va", 2, seeds, more), c = start("c", "va", 3, seeds, more);
    wire.right.enter();
    Process b = start("b", "vb", 2, seeds, more);
    expect_shared_world({&a, &b, &c}, "transport.multicast says so");
  });
}

TEST_F(UnicastProcess, AScenarioOfRealProcessesRunsOverIt) {
  Process all(folder, "scenario", PEERD_PROGRAM,
              {"scenario", kScenario, "--set", kSettings[1], "--set", kSettings[2], "--set", "duration_s=1", "--set",
               "transport.multicast=never", "--out", (folder / "out").string()});
  ASSERT_EQ(all.exit_code(30), 0) << all.out() << all.err();
  const auto log = testing_support::text_of(folder / "out/run-001.a.log");
  EXPECT_THAT(
      log, AllOf(HasSubstr("unicast at port"), HasSubstr("peer b (id 2) joined"), HasSubstr("peer c (id 3) joined")));
}

}  // namespace peerd::unicast_process_test
