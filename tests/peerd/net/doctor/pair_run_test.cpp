// `peerd doctor --with` on two computers: network namespaces with a wire between, or a switch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/net/wire.hpp"

namespace peerd::doctor::pair_run_test {

using net::testing_support::Namespace;
using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using peerd::testing_support::Process;
using peerd::testing_support::ScratchFolder;
using testing::HasSubstr;

using Words = std::vector<std::string>;

struct PairRun : testing::Test {
  struct Said {
    int exit_code;
    std::string out, err;
    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
  };
  [[nodiscard]] std::unique_ptr<Process> start(const std::string& name, Words more, int wait_s = 20) const {
    more.insert(more.begin(), {"doctor", "--port", std::to_string(own_port(0)), "--wait", std::to_string(wait_s)});
    return std::make_unique<Process>(folder, name, PEERD_PROGRAM, more);
  }
  static Said end(Process& p) {
    const int code = p.exit_code(60);
    return {code, p.out(), p.err()};
  }
  // Both sides at once: what left and right have said.
  [[nodiscard]] std::pair<Said, Said> run(const Wire& wire, const Words& left, const Words& right,
                                          int wait_s = 20) const {
    wire.left.enter();
    const auto a = start("left", left, wait_s);
    wire.right.enter();
    const auto b = start("right", right, wait_s);
    return {end(*a), end(*b)};
  }
  [[nodiscard]] std::pair<Said, Said> over_wire(const Wire& wire, Words more) const {
    Words left{"--interface", "va", "--with", "192.0.2.2"}, right{"--interface", "vb", "--with", "192.0.2.1"};
    left.insert(left.end(), more.begin(), more.end());
    right.insert(right.end(), more.begin(), more.end());
    return run(wire, left, right);
  }
  ScratchFolder folder;
};

// wl (198.51.100.1, left) ---- ml, a bridge ms, mr (in the middle) ---- wr (198.51.100.2, right), beside the wire.
struct Switch {
  std::string lay(const Wire& wire) {
    if (!middle.problem().empty()) return middle.problem();
    if (!end_of(wire.left, "wl", "ml", "1") || !end_of(wire.right, "wr", "mr", "2")) return "no second pair here";
    middle.enter();
    if (!shell("ip link add ms type bridge mcast_snooping 0 && ip link set ml master ms && ip link set mr master ms && "
               "ip link set ml up && ip link set mr up && ip link set ms up"))
      return "no bridge here (kernel module bridge)";
    wire.right.enter();
    const bool right_up = Wire::comes_up("wr");
    wire.left.enter();
    return right_up && Wire::comes_up("wl") ? "" : "the switch does not come up within 5 s";
  }
  [[nodiscard]] bool end_of(const Namespace& computer, const std::string& near, const std::string& far,
                            const std::string& host) const {
    computer.enter();
    return shell("ip link add " + near + " type veth peer name " + far + " && ip link set " + far + " netns " +
                 middle.path() + " && ip addr add 198.51.100." + host + "/24 dev " + near + " && ip link set " + near +
                 " up");
  }
  [[nodiscard]] bool configure(const std::string& command) const {
    middle.enter();
    return shell(command);
  }
  Namespace middle;
};

const Words kLeftOfSwitch{"--interface", "wl", "--with", "198.51.100.2"},
    kRightOfSwitch{"--interface", "wr", "--with", "198.51.100.1"};

TEST_F(PairRun, AllWorksOverAWire) {
  with_wire([&](const Wire& wire) {
    const auto [left, right] = over_wire(wire, {"--json"});
    for (const Said& said : {left, right}) {
      ASSERT_EQ(said.exit_code, 0) << said.out << said.err;
      const auto with = said.json()["with"];
      for (const char* path : {"unicast", "multicast"}) {
        for (const char* way : {"to", "from"}) EXPECT_GE(with[path][way]["arrived"].get<int>(), 190) << path << way;
      }
      EXPECT_EQ(with["unicast"]["to"]["largest_bytes"], 1472);
      EXPECT_EQ(with["tcp"], nlohmann::json({{"to", "works"}, {"from", "works"}}));
      EXPECT_GT(with["round_trip_ms"].get<double>(), 0.0);
      EXPECT_LT(std::abs(with["clock_ahead_ms"].get<double>()), with["round_trip_ms"].get<double>() + 1.0)
          << "it is one computer";
    }
    EXPECT_THAT(left.err, HasSubstr("waiting up to 20 s for 192.0.2.2: start peerd doctor --with 192.0.2.1 there"));
  });
}

TEST_F(PairRun, Ipv6WorksOverAWire) {
  with_wire([&](const Wire& wire) {
    const auto [left, right] = run(wire, {"--group", "ff15::50:0", "--interface", "va", "--with", "fe80::2%va"},
                                   {"--group", "ff15::50:0", "--interface", "vb", "--with", "fe80::1%vb"});
    EXPECT_EQ(left.exit_code, 0) << left.out << left.err;
    EXPECT_EQ(right.exit_code, 0) << right.out << right.err;
  });
}

TEST_F(PairRun, ASwitchThatForwardsNoGroupsLeavesUnicast) {
  with_wire([&](const Wire& wire) {
    Switch between;
    ASSERT_EQ(between.lay(wire), "");
    ASSERT_TRUE(between.configure("bridge link set dev ml mcast_flood off && bridge link set dev mr mcast_flood off"));
    const auto [left, right] = run(wire, kLeftOfSwitch, kRightOfSwitch);
    const std::string port = std::to_string(own_port(0));
    EXPECT_EQ(left.exit_code, 1) << left.out << left.err;
    EXPECT_THAT(left.out, HasSubstr("transport.peers=[\"198.51.100.2:" + port + "\"]"));
    EXPECT_THAT(left.out, HasSubstr("unicast         from here to 198.51.100.2: "));
    EXPECT_EQ(right.exit_code, 1);
    // What it says helps.
    Words never{"--set", "transport.multicast=never"};
    Words a = kLeftOfSwitch, b = kRightOfSwitch;
    a.insert(a.end(), never.begin(), never.end());
    b.insert(b.end(), never.begin(), never.end());
    const auto [left_again, right_again] = run(wire, a, b);
    EXPECT_EQ(left_again.exit_code, 0) << left_again.out << left_again.err;
    EXPECT_EQ(right_again.exit_code, 0);
  });
}

// Snooping begins a response interval after the bridge has begun to ask: 0.1 s here. Without flooding, a group reaches
// a port only because its computer has joined it.
TEST_F(PairRun, ASwitchThatSnoopsAndAsksForwardsGroups) {
  with_wire([&](const Wire& wire) {
    Switch between;
    ASSERT_EQ(between.lay(wire), "");
    ASSERT_TRUE(
        between.configure("ip link set ms type bridge mcast_query_response_interval 10 && "
                          "ip link set ms type bridge mcast_snooping 1 mcast_querier 1 && "
                          "bridge link set dev ml mcast_flood off && bridge link set dev mr mcast_flood off"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto [left, right] = run(wire, kLeftOfSwitch, kRightOfSwitch);
    EXPECT_EQ(left.exit_code, 0) << left.out << left.err;
    EXPECT_EQ(right.exit_code, 0) << right.out << right.err;
  });
}

TEST_F(PairRun, AHostThatIsNoneIsWrongUse) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    const std::pair<const char*, const char*> table[] = {{"192.0.2.1", "is this computer"},
                                                         {"127.0.0.1", "is this computer"},
                                                         {"192.0.2.2:0", "is no HOST:PORT"},
                                                         {"192.0.2.2:x", "is no HOST:PORT"}};
    for (const auto& [host, text] : table) {
      const auto p = start("left", {"--interface", "va", "--with", host});
      const Said said = end(*p);
      EXPECT_EQ(said.exit_code, 2) << host << said.err;
      EXPECT_THAT(said.err, HasSubstr(text));
    }
  });
}

}  // namespace peerd::doctor::pair_run_test
