// Real peers, driven by `peerd ctl` as a person would.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <nlohmann/json.hpp>

#include "peerd/cli/client/ctl_command.hpp"
#include "peerd/peer/control/control_server.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"

namespace peerd::ctl_command_test {

using net::testing_support::own_port;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::Process;
using Words = std::vector<std::string>;

constexpr const char* kWorlds = PEERD_SOURCE_DIR "/configs/worlds/keys.wrl";

// Each test uses a port of its own: slots 10 to 15 of this process.
class Control : public testing::Test {
 protected:
  Process start_peer(const std::string& name, int id, const std::string& owns, unsigned slot, Words more) {
    Words words{"run",
                "--world",
                kWorlds,
                "--name",
                name,
                "--id",
                std::to_string(id),
                "--own",
                owns,
                "--interface",
                "lo",
                "--port",
                std::to_string(own_port(slot))};
    words.insert(words.end(), more.begin(), more.end());
    return Process(folder, name, PEERD_PROGRAM, words);
  }
  struct Said {
    int code;
    std::string out, err;
  };
  Said ctl(const Words& words) {
    Words all{"ctl"};
    all.insert(all.end(), words.begin(), words.end());
    Process p(folder, "ctl" + std::to_string(++calls), PEERD_PROGRAM, all);
    const int code = p.exit_code(10);
    return {code, p.out(), p.err()};
  }
  json ask(const std::string& socket, const std::string& what) {
    const Said said = ctl({"--control", socket, what, "--json"});
    EXPECT_EQ(said.code, 0) << said.err;
    return said.code == 0 ? json::parse(said.out) : json();
  }
  // The peer's status once motions have begun.
  json wait_for_start(const std::string& socket) {
    json status;
    for (int tries = 0; tries < 200; ++tries) {
      status = ask(socket, "status");
      if (status["since_start_s"].is_number() && status["since_start_s"] >= 0) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return status;
  }
  // An object as a peer reports it; waits until it has that velocity.
  json wait_for_velocity(const std::string& socket, const std::string& what, const std::string& path, const json& v) {
    json last;
    for (int tries = 0; tries < 100; ++tries) {
      const json reply = ask(socket, what);
      for (const json& o : reply["objects"]) {
        if (o["path"] == path) last = o;
      }
      if (!last.is_null() && last["velocity_m_s"] == v) return last;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ADD_FAILURE() << path << " does not move so: " << last;
    return last;
  }
  [[nodiscard]] std::string socket(const std::string& name) const { return (folder / (name + ".sock")).string(); }

  testing_support::ScratchFolder folder;
  int calls = 0;
};

TEST_F(Control, EveryStatusSaysThatAPeerIsOpen) {
  Process sealed = start_peer("a", 1, "RED", 10, {"--control", socket("a"), "--store", ""});
  Process open = start_peer("b", 2, "BLUE", 11, {"--control", socket("b"), "--store", "", "--open"});
  ASSERT_TRUE(sealed.says("listens for peerd ctl", 10) && open.says("listens for peerd ctl", 10));
  EXPECT_EQ(ask(socket("a"), "status")["session"]["sealed"], true);
  EXPECT_EQ(ask(socket("b"), "status")["session"]["sealed"], false);
  EXPECT_THAT(ask(socket("a"), "status")["session"]["sealed_by"].get<std::string>(), testing::StartsWith("the key /"));
  EXPECT_EQ(ask(socket("b"), "status")["session"]["sealed_by"], nullptr);
  constexpr const char* kOpen = "open: whoever is on this network can listen, and speak as any peer";
  EXPECT_THAT(ctl({"--control", socket("a"), "status"}).out,
              testing::AllOf(HasSubstr("sealed by the key /"), testing::Not(HasSubstr(kOpen))));
  EXPECT_THAT(ctl({"--control", socket("b"), "status"}).out, HasSubstr(kOpen));
}

TEST_F(Control, AKeySetsACarInMotionAndTheOtherPeerSeesIt) {
  const std::string at_a = socket("a"), at_b = socket("b");
  Process a = start_peer("a", 1, "RED", 10, {"--control", at_a});
  Process b = start_peer("b", 2, "BLUE", 10, {"--control", at_b});
  ASSERT_TRUE(a.says("peer b (id 2) joined", 5) && b.says("peer a (id 1) joined", 5)) << a.out() << a.err() << b.out();
  ASSERT_TRUE(a.says("listens for peerd ctl at " + at_a, 1));
  const json status = wait_for_start(at_a);
  EXPECT_EQ(status["peer"]["name"], "a");
  ASSERT_EQ(status["members"].size(), 1u);
  EXPECT_EQ(status["members"][0]["name"], "b");
  EXPECT_GT(status["counters"]["net.packets_in"], 0);
  EXPECT_EQ(status["counters"]["net.in_queue_overflow"], 0);

  const Said key = ctl({"--control", at_a, "key", "ArrowUp"});
  EXPECT_EQ(key.code, 0) << key.out << key.err;
  EXPECT_THAT(key.out, HasSubstr("FASTER changes the velocity of RED by (0.000, 0.000, -2.000) m/s"));
  const json own = wait_for_velocity(at_a, "status", "RED", {0, 0, -2});
  EXPECT_EQ(own["own"], true);
  const json seen = wait_for_velocity(at_b, "objects", "RED", {0, 0, -2});
  EXPECT_EQ(seen["own"], false);
  EXPECT_EQ(seen["owner"], 1);
  EXPECT_TRUE(a.says("ArrowUp: FASTER changes the velocity of RED", 1)) << "the peer's log has it too";

  EXPECT_EQ(ctl({"--control", at_a, "key", "ArrowUp", "--shift"}).code, 0);
  (void)wait_for_velocity(at_b, "objects", "RED", {0, 0, -7});
  EXPECT_EQ(ctl({"--control", at_a, "key", "--value", "32"}).code, 0);
  (void)wait_for_velocity(at_b, "objects", "RED", {0, 0, 0});

  const Said refused = ctl({"--control", at_a, "key", "w"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.out, HasSubstr("UPHILL does not move RAMP/BLUE: peer b (id 2) runs it"));
  const Said unheard = ctl({"--control", at_a, "key", "q"});
  EXPECT_EQ(unheard.code, 1);
  EXPECT_THAT(unheard.out, HasSubstr("no enabled KeySensor listens"));

  EXPECT_EQ(ctl({"--control", at_a, "leave"}).code, 0);
  EXPECT_EQ(a.exit_code(2), 0) << a.err();
  EXPECT_THAT(a.out(), HasSubstr("leaving: as requested"));
  EXPECT_TRUE(b.says("peer a (id 1) left", 2));
  EXPECT_FALSE(std::filesystem::exists(at_a));
  const Said nobody = ctl({"--control", at_a, "status"});
  EXPECT_EQ(nobody.code, 3);
  EXPECT_THAT(nobody.err, HasSubstr("no peer answers at " + at_a));
  b.signal(SIGTERM);
  EXPECT_EQ(b.exit_code(2), 0);
  EXPECT_FALSE(std::filesystem::exists(at_b));
}

// Each was started by hand, knows of no other, and begins with whoever is there. A third one runs nothing.
TEST_F(Control, PeersOfNoConfigurationHaveOneStartAndAWatcherBeginsNothing) {
  const std::string at_w = socket("w"), at_a = socket("a"), at_b = socket("b");
  Process w(folder, "w", PEERD_PROGRAM,
            {"run", "--world", kWorlds, "--name", "w", "--id", "1", "--interface", "lo", "--port",
             std::to_string(own_port(15)), "--control", at_w, "--store", ""});
  ASSERT_TRUE(w.says("in session", 5)) << w.out() << w.err();
  EXPECT_TRUE(ask(at_w, "status")["world_time_s"].is_null());
  Process a = start_peer("a", 2, "RED", 15, {"--control", at_a});
  ASSERT_TRUE(a.says("peer w (id 1) joined", 5)) << a.out() << a.err();
  const auto start_at = [&](const std::string& socket) {
    const json status = wait_for_start(socket);
    return status["session"]["time_s"].get<double>() - status["since_start_s"].get<double>();
  };
  const double start = start_at(at_a);
  Process b = start_peer("b", 3, "BLUE", 15, {"--control", at_b});
  ASSERT_TRUE(b.says("in session", 5)) << b.out() << b.err();
  EXPECT_NEAR(start_at(at_b), start, 1e-3);
  EXPECT_NEAR(start_at(at_w), start, 1e-3);
}

TEST_F(Control, ByDefaultItIsInTheUsersRuntimeFolder) {
  const auto runtime = folder / "run";
  std::filesystem::create_directory(runtime);
  setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  EXPECT_EQ(ctl({"status"}).code, 3) << "nobody there";
  {
    Process a = start_peer("a", 1, "RED", 12, {}), b = start_peer("b", 2, "BLUE", 12, {});
    ASSERT_TRUE(a.says("run/peerd/a.sock", 5) && b.says("run/peerd/b.sock", 5)) << a.out() << b.out();
    const Said which = ctl({"status"});
    EXPECT_EQ(which.code, 2);
    EXPECT_THAT(which.err, HasSubstr("--name NAME; there are a, b"));
    EXPECT_THAT(ctl({"status", "--name", "b"}).out, HasSubstr("peer b (id 2)"));
    Process twin = start_peer("a", 3, "BLUE", 13, {});
    EXPECT_TRUE(twin.says("run/peerd/a-3.sock", 5)) << "each has a socket of its own";
    for (Process* each : {&twin, &b}) {
      each->signal(SIGTERM);
      EXPECT_EQ(each->exit_code(2), 0);
    }
    EXPECT_THAT(ctl({"status"}).out, HasSubstr("peer a (id 1)")) << "the only one left";
    Process off = start_peer("off", 4, "BLUE", 13, {"--control", ""});
    EXPECT_TRUE(off.says("in session", 5)) << off.out() << off.err();
    EXPECT_FALSE(std::filesystem::exists(runtime / "peerd/off.sock"));
  }
  unsetenv("XDG_RUNTIME_DIR");
}

TEST_F(Control, WrongUseIsOneSentence) {
  for (const auto& [words, sentence] :
       std::vector<std::pair<Words, std::string>>{{{"key", "ArowUp"}, "did you mean \"ArrowUp\"?"},
                                                  {{"key"}, "which key?"},
                                                  {{"key", "a", "--value", "65"}, "which key?"},
                                                  {{"key", "--value", "65", "--shift"}, "--state"},
                                                  {{"key", "a", "--state", "256"}, "--state"},
                                                  {{"fly"}, "peerd ctl has no command fly"}}) {
    const Said said = ctl(words);
    EXPECT_EQ(said.code, 2) << sentence;
    EXPECT_THAT(said.err, HasSubstr(sentence));
  }
}

// A peer whose clock is wrong, as a script sees it.
TEST(ControlExitCode, IsOneWhereAnEditHasNotTakenEffect) {
  const testing_support::ScratchFolder folder;
  const std::filesystem::path socket = folder / "peer.sock";
  boost::asio::io_context io;
  const auto answer = [](std::string_view request) {
    const bool is_edit = json::parse(request).at("do") == "add";
    return control::Answer{
        is_edit
            ? R"({"v":1,"ok":true,"edit":"add","done":true,"operation":{"author":7,"number":1}})"
            : R"({"v":1,"ok":true,"edit":"add","done":true,"operation":{"author":7,"number":1},"applied":false,"held":true,"alone":false})"};
  };
  const auto server = control::ControlServer::open(io, socket, answer);
  ASSERT_TRUE(server) << server.error().text;
  std::jthread peer([&] { io.run(); });
  EXPECT_EQ(run_ctl({.socket = socket, .request = R"({"do":"add"})", .patience = std::chrono::milliseconds(50)}), 1);
  io.stop();
}

}  // namespace peerd::ctl_command_test
