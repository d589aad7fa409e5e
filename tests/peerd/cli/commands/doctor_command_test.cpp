#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/has_members.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/net/wire.hpp"

namespace peerd::doctor_command_test {

using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::Process;
using testing_support::ScratchFolder;

using Words = std::vector<std::string>;

struct Doctor : testing::Test {
  struct Said {
    int exit_code;
    std::string out, err;
  };
  Said ask(Words more) {
    more.insert(more.begin(), {"doctor", "--port", std::to_string(own_port(0))});
    Process p(folder, "doctor", PEERD_PROGRAM, more);
    const int code = p.exit_code(10);
    return {code, p.out(), p.err()};
  }
  nlohmann::json ask_json(Words more, int exit_code) {
    more.push_back("--json");
    const Said said = ask(more);
    EXPECT_EQ(said.exit_code, exit_code) << said.out << said.err;
    EXPECT_EQ(said.err, "");
    return nlohmann::json::parse(said.out);
  }
  ScratchFolder folder;
};

TEST_F(Doctor, SaysThatMulticastWorks) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    const auto j = ask_json({"--interface", "va", "--set", "transport.receive_buffer_bytes=8192"}, 0);
    EXPECT_THAT(j, HasMembers(R"({"interface": {"name": "va"}, "multicast": {"works": true, "kernel_stamps": true}})"));
    EXPECT_GT(j["multicast"]["took_us"].get<double>(), 0.0);
    EXPECT_EQ(j["unicast_needed"], false);
    EXPECT_EQ(j["transport"], "multicast");
    EXPECT_EQ(j["receive_buffer_bytes"], nlohmann::json({{"asked", 8192}, {"granted", 8192}}));
    const Said said = ask({"--interface", "va"});
    EXPECT_EQ(said.exit_code, 0);
    EXPECT_THAT(said.out, AllOf(HasSubstr("multicast       works"), HasSubstr("unicast         not needed"),
                                HasSubstr("reach           va is connected"),
                                HasSubstr("would run: group 239.192.80.0 port " + std::to_string(own_port(0)))));
  });
}

TEST_F(Doctor, ReadsTheTableOfAScenarioAndTheSettingsOverIt) {
  folder.write("s.toml",
               "world = \"w.wrl\"\n[transport]\ninterface = \"lo\"\nreceive_buffer_bytes = 8192\ndscp = 46\n");
  const Words config{"--config", (folder / "s.toml").string()};
  EXPECT_EQ(ask_json(config, 1)["receive_buffer_bytes"], nlohmann::json({{"asked", 8192}, {"granted", 8192}}));
  Words more = config;
  more.insert(more.end(), {"--set", "transport.multicast=never", "--set", "transport.peers=[\"127.0.0.1:4000\"]"});
  const auto j = ask_json(more, 1);
  EXPECT_THAT(j, HasMembers(R"(
    {"transport": "unicast", "only_this_computer": true, "unicast_needed": true,
    "multicast": {"tried": false}})"));
  EXPECT_EQ(j["unicast_peers"], nlohmann::json({"127.0.0.1:4000"}));
}

TEST_F(Doctor, SaysWhatIsMissing) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va multicast off"));
    const auto alone = ask_json({"--interface", "va"}, 3);
    EXPECT_EQ(alone["multicast"]["works"], false);
    EXPECT_EQ(alone["unicast_needed"], true);
    EXPECT_TRUE(alone["transport"].is_null());
    EXPECT_THAT(alone.value("problem", ""), HasSubstr("transport.peers"));
    const Words with_peers{"--interface", "va", "--set", "transport.peers=[\"192.0.2.2:4000\"]"};
    EXPECT_EQ(ask_json(with_peers, 0)["transport"], "unicast");
    Words always = with_peers;
    always.insert(always.end(), {"--set", "transport.multicast=always"});
    EXPECT_TRUE(ask_json(always, 3)["transport"].is_null());
  });
}

// As on a computer without a network: nothing says that lo is meant.
TEST_F(Doctor, WhatReachesThisComputerOnlyIsAFinding) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va down && ip link set lo up"));
    const auto alone = ask_json({}, 1);
    EXPECT_THAT(alone, HasMembers(R"(
      {"interface": {"name": "lo"}, "only_this_computer": true, "unicast_needed": true})"));
    const Said said = ask({});
    EXPECT_EQ(said.exit_code, 1);
    EXPECT_THAT(said.out, AllOf(HasSubstr("peers on other computers will not be heard: lo, as no other can multicast"),
                                HasSubstr("transport.peers=[")));
    EXPECT_EQ(ask_json({"--interface", "lo"}, 1)["only_this_computer"], true) << "meant or not";
    EXPECT_EQ(ask_json({"--set", "transport.multicast=never"}, 1)["only_this_computer"], true);
    const Words far{"--set", "transport.multicast=never", "--set", "transport.peers=[\"192.0.2.2:4000\"]"};
    EXPECT_EQ(ask_json(far, 1)["only_this_computer"], true);
    EXPECT_THAT(ask(far).out, HasSubstr("there is no route to 192.0.2.2:4000"));
  });
}

TEST_F(Doctor, ATtlOfNoHopsStaysOnThisComputer) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    EXPECT_EQ(ask_json({"--interface", "va", "--set", "transport.ttl=0"}, 1)["only_this_computer"], true);
  });
}

TEST_F(Doctor, WrongSettingsAreWrongUse) {
  const std::pair<Words, const char*> table[] = {
      {{"--set", "transport.dcsp=3"}, "did you mean"},
      {{"--set", "transport.dscp=64"}, "transport.dscp"},
      {{"--set", "transport.multicast=maybe"}, "transport.multicast"},
      {{"--set", "transport.receive_buffer_bytes=1"}, "transport.receive_buffer_bytes"},
      {{"--set", "transport.group_pool=70000"}, "transport.group_pool"},
      {{"--group", "10.0.0.1"}, "10.0.0.1"},
      {{"--config", "/none.toml"}, "none.toml"},
  };
  for (const auto& [words, text] : table) {
    const Said said = ask(words);
    EXPECT_EQ(said.exit_code, 2) << text;
    EXPECT_THAT(said.err, HasSubstr(text));
  }
  EXPECT_EQ(ask({"--set", "transport.multicast=never", "--set", "transport.peers=[\"nowhere\"]"}).exit_code, 2);
}

// Whoever goes through a relay or a NATS server needs a route there, and no multicast.
TEST_F(Doctor, LooksForTheWayToRelaysAndServers) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    for (const auto& [key, address, kind] : {std::tuple{"transport.relays", "192.0.2.2:47480", "relay"},
                                             {"transport.nats", "nats://192.0.2.2:4222", "nats"}}) {
      const auto j = ask_json({"--set", std::string(key) + "=[\"" + address + "\"]"}, 0);
      EXPECT_EQ(j["transport"], kind);
      EXPECT_EQ(j["multicast"]["tried"], false);
      EXPECT_EQ(j["unicast_needed"], false);
      const Said said = ask({"--set", std::string(key) + "=[\"" + address + "\"]"});
      EXPECT_THAT(said.out,
                  AllOf(HasSubstr("not tried: " + std::string(key) + " says so"),
                        HasSubstr("there is a route to 192.0.2.2:"), testing::Not(HasSubstr("transport.peers"))));
      EXPECT_EQ(ask({"--set", std::string(key) + "=[\"" +
                                  (kind == std::string("nats") ? "nats://203.0.113.9:1" : "203.0.113.9:1") + "\"]"})
                    .exit_code,
                1);
    }
  });
}

}  // namespace peerd::doctor_command_test
