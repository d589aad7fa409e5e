// The real program with a store whose edits are stamped by a clock that was wrong.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"

namespace peerd::stamp_process_test {

using net::testing_support::own_port;
using testing_support::Process;
using Words = std::vector<std::string>;

class WrongClock : public testing_support::ControlledPeers {
 protected:
  WrongClock() {
    folder.write("world.wrl", "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { } } }\n");
  }

  [[nodiscard]] std::filesystem::path store_of(const std::string& name) const { return folder / ("store-" + name); }
  Process run(const std::string& name, const Words& more = {}) const {
    Words words{"run",
                "--world",
                (folder / "world.wrl").string(),
                "--port",
                std::to_string(own_port(11)),
                "--interface",
                "lo",
                "--store",
                store_of(name).string(),
                "--world-name",
                called};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  // Its clock is that far ahead.
  Process run_ahead(const std::string& name, std::int64_t ahead_s) const {
    return run(name, {"--set", "peer." + name + ".clock_offset_s=" + std::to_string(ahead_s)});
  }
  // It has made an edit, and has left.
  void leave_with(Process peer, const std::string& name, const std::string& def) const {
    ASSERT_TRUE(is_in_session(name) && add(name, def)) << peer.out() << peer.err();
    peer.signal(SIGTERM);
    ASSERT_EQ(peer.exit_code(10), 0) << peer.out();
  }
  [[nodiscard]] bool has(const std::string& name, const std::string& def) const {
    return world_of(name).find("DEF " + def + ' ') != std::string::npos;
  }

  const std::string called = "stamps-" + std::to_string(getpid());
};

TEST_F(WrongClock, EditsOfAWrongClockDoNotHideNewOnes) {
  leave_with(run_ahead("a", 7200), "a", "OLD");
  Process b = run("b");
  ASSERT_TRUE(is_in_session("b")) << b.out();
  Process a = run("a");
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
  EXPECT_TRUE(a.says("begins another log", 10)) << a.out();
  ASSERT_TRUE(is_in_session("a") && wait_until([&] { return members_of("a") == 1; })) << a.out();
  ASSERT_TRUE(add("a", "NEW")) << a.out();
  EXPECT_TRUE(wait_until([&] { return has("b", "NEW"); })) << b.out();
  a.signal(SIGKILL);
  ASSERT_EQ(a.exit_code(5), -1);
  Process again = run("a");
  ASSERT_TRUE(is_in_session("a") && add("a", "NEWER")) << again.out();
  EXPECT_TRUE(wait_until([&] { return has("b", "NEWER") && has("a", "NEW"); })) << again.out();
}

}  // namespace peerd::stamp_process_test
