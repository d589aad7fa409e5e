// Real peers are recorded while keys are pressed, a program moves an object, and requests are made; their replays send
// the same bytes and log the same states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"

namespace peerd::record_test {

using net::testing_support::own_port;
using testing::HasSubstr;
using testing_support::Process;
using testing_support::text_of;
using Words = std::vector<std::string>;

constexpr const char* kScenario = R"toml(world = "keys.wrl"
[replication]
error_threshold_m = 0.05
[peer.a]
id = 1
owns = ["RED", "BLUE"]
clock_offset_s = 2
[peer.a.motion.BLUE]
outside = true
[peer.a.feed]
udp = "127.0.0.1:0"
[[peer.a.key]]
at_s = 0.2
key = "ArrowUp"
[peer.b]
id = 2
)toml";

class Record : public testing::TestWithParam<const char*> {
 protected:
  Record() {
    std::filesystem::copy(PEERD_SOURCE_DIR "/configs/worlds/keys.wrl", folder / "keys.wrl");
    folder.write("s.toml", kScenario);
  }
  Process start(const std::string& name, unsigned slot, const Words& more = {"--opened"}) {
    Words words{"record",
                "--config",
                (folder / "s.toml").string(),
                "--peer",
                name,
                "--interface",
                "lo",
                "--port",
                "",
                "--record",
                file(name, "rows"),
                "--control",
                file(name, "sock"),
                "--out",
                file(name, "pcapng")};
    words.insert(words.end(), more.begin(), more.end());
    std::string& port = words[8];
    if (std::string(GetParam()) == "Unicast") {
      port = std::to_string(own_port(slot));
      words.insert(words.end(), {"--set", "transport.multicast=never", "--set",
                                 "transport.peers=[\"127.0.0.1:" + std::to_string(own_port(12)) + "\"]"});
    } else {
      port = std::to_string(own_port(12));
    }
    return Process(folder, name, PEERD_PROGRAM, words);
  }
  nlohmann::json ctl(const Words& words, int code = 0) {
    Words all{"ctl", "--control", file("a", "sock"), "--json"};
    all.insert(all.end(), words.begin(), words.end());
    Process p(folder, "ctl" + std::to_string(++calls), PEERD_PROGRAM, all);
    EXPECT_EQ(p.exit_code(10), code) << p.out() << p.err();
    return nlohmann::json::parse(p.out(), nullptr, false);
  }
  void feed_blue(const Process& a) {
    std::smatch found;
    const std::string out = a.out();
    ASSERT_TRUE(std::regex_search(out, found, std::regex("takes poses by UDP at 127.0.0.1 port ([0-9]+)"))) << out;
    namespace asio = boost::asio;
    asio::io_context io;
    asio::ip::udp::socket program(io, asio::ip::udp::v4());
    program.connect({asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(std::stoi(found[1]))});
    for (int i = 0; i < 30; ++i) {
      const std::string pose =
          R"({"do": "pose", "object": "BLUE", "position_m": [4, 0, )" + std::to_string(-0.1 * i) + "]}";
      program.send(asio::buffer(i == 7 ? std::string("no pose\0at all", 14) : pose));
      std::this_thread::sleep_for(std::chrono::milliseconds(33));
    }
  }
  nlohmann::json replay(const std::string& name, const Words& more = {}) {
    Words words{"replay", file(name, "pcapng"), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    Process p(folder, "replay" + name, PEERD_PROGRAM, words);
    EXPECT_EQ(p.exit_code(30), 0) << p.out() << p.err();
    return nlohmann::json::parse(p.out(), nullptr, false);
  }
  [[nodiscard]] std::string file(const std::string& name, const std::string& kind) const {
    return (folder / (name + "." + kind)).string();
  }

  testing_support::ScratchFolder folder;
  int calls = 0;
};

TEST_P(Record, WhatARealPeerDidIsReplayed) {
  Process a = start("a", 12), b = start("b", 13);
  ASSERT_TRUE(a.says("peer b (id 2) joined", 10)) << a.out() << a.err() << b.out() << b.err();
  ASSERT_TRUE(b.says("peer a (id 1) joined", 10)) << b.out() << b.err();
  nlohmann::json since;
  for (int tries = 0; tries < 300 && !(since.is_number() && since >= 0.3); ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    since = ctl({"status"})["since_start_s"];
  }
  ASSERT_TRUE(since.is_number());
  EXPECT_EQ(ctl({"key", "ArrowUp"})["done"], true);
  feed_blue(a);
  EXPECT_EQ(ctl({"pose", "BLUE", "4", "0", "7"})["done"], true);
  (void)ctl({"objects"});
  (void)ctl({"key", "w"}, 1);  // no KeySensor of this peer listens to it
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  (void)ctl({"leave"});
  EXPECT_EQ(a.exit_code(5), 0) << a.out() << a.err();
  ASSERT_TRUE(b.says("peer a (id 1) left", 5));
  b.signal(SIGKILL);
  EXPECT_EQ(b.exit_code(5), -1);

  const nlohmann::json of_a = replay("a", {"--record", file("a", "again")});
  EXPECT_EQ(of_a["same"], true) << of_a;
  EXPECT_EQ(of_a["cut_off"], false);
  EXPECT_GT(of_a["datagrams_out"], 20) << of_a;
  EXPECT_GT(of_a["datagrams_in"], 10) << of_a;
  EXPECT_TRUE(text_of(file("a", "rows")) == text_of(file("a", "again"))) << "truths, ghosts and counters";
  EXPECT_THAT(text_of(file("a", "again")), HasSubstr("N keys 3\n")) << "one by the configuration, two by ctl";
  EXPECT_THAT(text_of(file("a", "again")), HasSubstr("N pose_messages_refused 1\n"));
  EXPECT_THAT(text_of(file("a", "again")), HasSubstr("N poses_taken 30\n"));
  // A killed peer leaves a capture of everything that it did.
  const nlohmann::json of_b = replay("b");
  EXPECT_EQ(of_b["same"], true) << of_b;
  EXPECT_GT(of_b["datagrams_out"], 10) << of_b;
  EXPECT_GT(of_b["datagrams_in"], 20) << of_b;
}
// A sealed session's capture is so, too, unless somebody says otherwise.
TEST_P(Record, WhatIsNotOpenedStaysSealed) {
  Process a = start("a", 12, {}), b = start("b", 13);
  ASSERT_TRUE(a.says("peer b (id 2) joined", 10)) << a.out() << a.err();
  EXPECT_THAT(a.out(), HasSubstr("records datagrams as they are on the network, sealed"));
  for (Process* each : {&a, &b}) {
    each->signal(SIGTERM);
    EXPECT_EQ(each->exit_code(5), 0) << each->out() << each->err();
  }
  const std::string sealed = text_of(file("a", "pcapng")), opened = text_of(file("b", "pcapng"));
  EXPECT_THAT(sealed.substr(0, 300), HasSubstr("sealed as they were on the network"));
  EXPECT_THAT(opened.substr(0, 300), HasSubstr("as secret as the session's key"));
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(file("b", "pcapng")).permissions(), perms::owner_read | perms::owner_write);
  Process replay(folder, "replay", PEERD_PROGRAM, {"replay", file("a", "pcapng")});
  EXPECT_EQ(replay.exit_code(30), 1);
  EXPECT_THAT(replay.err(), HasSubstr("peerd record --opened has both"));
}
INSTANTIATE_TEST_SUITE_P(Over, Record, testing::Values("Multicast", "Unicast"),
                         [](const auto& c) { return std::string(c.param); });

}  // namespace peerd::record_test
