// The real program, as a service manager and a terminal start it.
#include "peerd/daemon/open/peer_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"
#include "tests/peerd/net/os/notified.hpp"

namespace peerd::peer_service_test {
namespace {

using net::testing_support::own_port;
using testing::HasSubstr;
using testing_support::Notified;
using testing_support::Process;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
DEF CUBE Transform { translation 0 50 0 children Shape { geometry Box { } } }
)";
constexpr const char* kScenario = "world = \"w.wrl\"\n[peer.a]\nid = 1\nowns = [\"CAR\"]\n";

class ServedPeer : public testing_support::ControlledPeers {
 protected:
  ServedPeer() {
    folder.write("w.wrl", kWorld);
    folder.write("s.toml", kScenario);
    setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "400000", 1);
  }
  ~ServedPeer() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }
  std::vector<std::string> words() const {
    return {"run",
            "--config",
            (folder / "s.toml").string(),
            "--interface",
            "lo",
            "--port",
            std::to_string(own_port(7)),
            "--control",
            (folder / "a.sock").string()};
  }
  Process start() { return {folder, "a", PEERD_PROGRAM, words()}; }
  // In a session of its own, with that terminal or, where it is empty, with none.
  Process start_by_setsid(const std::string& terminal) {
    std::string line = terminal.empty() ? "exec setsid " : "exec setsid --ctty ";
    line += PEERD_PROGRAM;
    for (const std::string& word : words()) line += " '" + word + "'";
    if (!terminal.empty()) line += " <" + terminal;
    return {folder, "a", "/bin/sh", {"-c", line}};
  }
  // The peer says this of what it owns.
  [[nodiscard]] std::string owned() const {
    const nlohmann::json status = ask("a", {{"do", "status"}});
    return status.is_object() ? status.at("objects").dump() : std::string();
  }

  Notified notified;
};

TEST_F(ServedPeer, SaysThatItRunsThatItIsAliveAndThatItStops) {
  Process a = start();
  EXPECT_TRUE(notified.gets("READY=1", 10)) << a.out() << a.err();
  EXPECT_TRUE(is_in_session("a")) << "it is ready only once it takes part";
  EXPECT_TRUE(notified.gets("WATCHDOG=1", 10));
  EXPECT_TRUE(notified.gets("WATCHDOG=1", 10)) << "again and again";
  a.signal(SIGTERM);
  EXPECT_TRUE(notified.gets("STOPPING=1", 5));
  EXPECT_EQ(a.exit_code(5), 0) << a.out();
}

// A service manager would end a process that says so and goes on.
TEST_F(ServedPeer, DoesNotSayThatItStopsWhereItGoesOverToAnotherLine) {
  const auto run = [&](const std::string& name, const std::string& id, std::vector<std::string> more) {
    std::vector<std::string> words{"run",
                                   "--world",
                                   (folder / "w.wrl").string(),
                                   "--id",
                                   id,
                                   "--interface",
                                   "lo",
                                   "--port",
                                   std::to_string(own_port(7)),
                                   "--store",
                                   (folder / ("store-" + name)).string(),
                                   "--take-over"};
    words.insert(words.end(), more.begin(), more.end());
    return ControlledPeers::start(name, words);
  };
  unsetenv("NOTIFY_SOCKET");
  {
    Process b = run("b", "2", {});
    ASSERT_TRUE(is_in_session("b") && add("b", "OLD")) << b.out();
    b.signal(SIGTERM);
    ASSERT_EQ(b.exit_code(20), 0) << b.out();
  }
  Process a = run("a", "1", {"--fresh"});
  ASSERT_TRUE(is_in_session("a")) << a.out();
  setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
  Process b = run("b", "2", {});
  ASSERT_TRUE(is_in_session("b")) << b.out();
  ASSERT_TRUE(b.says("the store before is now", 5)) << b.out();
  const std::vector<std::string> said = notified.messages();
  EXPECT_EQ(std::ranges::count(said, "READY=1"), 2) << "of both lives";
  EXPECT_EQ(std::ranges::count(said, "STOPPING=1"), 0);
  EXPECT_TRUE(notified.gets("WATCHDOG=1", 10));
  b.signal(SIGTERM);
  EXPECT_TRUE(notified.gets("STOPPING=1", 5));
}

TEST_F(ServedPeer, SaysInWordsWhatItDoes) {
  Process a = start();
  EXPECT_TRUE(notified.gets("STATUS=peer a (id 1) in w.wrl, with 0 other peers", 10)) << a.out() << a.err();
}

TEST_F(ServedPeer, AHangUpReadsTheConfigurationAgain) {
  Process a = start();
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
  ASSERT_TRUE(wait_until([&] { return owned().find("CAR") != std::string::npos; })) << owned();
  (void)notified.messages();
  folder.write("s.toml", "world = \"w.wrl\"\n[peer.a]\nid = 1\nowns = [\"CUBE\"]\n[transport]\nttl = 4\n");
  a.signal(SIGHUP);
  EXPECT_TRUE(notified.gets("RELOADING=1", 5));
  EXPECT_TRUE(a.says("read its configuration again: now counts peer.a.owns", 5)) << a.out();
  EXPECT_THAT(a.out(), HasSubstr("counts when this peer is started again: transport.ttl"));
  EXPECT_TRUE(wait_until([&] {
    const std::string now = owned();
    return now.find("CUBE") != std::string::npos && now.find("CAR") == std::string::npos;
  })) << owned();
  folder.write("s.toml", "world = \"w.wrl\"\n[peer.a]\nid = \"one\"\n");
  a.signal(SIGHUP);
  EXPECT_TRUE(a.says("the configuration stays as it was: ", 5)) << a.out();
  EXPECT_THAT(a.out(), HasSubstr("s.toml:3:"));
  EXPECT_TRUE(a.running());
}

TEST_F(ServedPeer, WithoutATerminalAHangUpReadsTheConfigurationAgain) {
  unsetenv("NOTIFY_SOCKET");
  Process a = start_by_setsid("");
  ASSERT_TRUE(a.says("in session", 10)) << a.out() << a.err();
  a.signal(SIGHUP);
  EXPECT_TRUE(a.says("read its configuration again: nothing else is new", 5)) << a.out();
  EXPECT_TRUE(a.running());
}

TEST_F(ServedPeer, ATerminalThatIsClosedIsAReasonToLeave) {
  unsetenv("NOTIFY_SOCKET");
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(grantpt(terminal), 0);
  ASSERT_EQ(unlockpt(terminal), 0);
  Process a = start_by_setsid(ptsname(terminal));
  ASSERT_TRUE(a.says("in session", 10)) << a.out() << a.err();
  close(terminal);
  EXPECT_EQ(a.exit_code(5), 0) << a.out() << a.err();
  EXPECT_THAT(a.out(), HasSubstr("leaving: got SIGHUP: its terminal is closed"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.sock"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.sock.lock"));
}

}  // namespace
}  // namespace peerd::peer_service_test
