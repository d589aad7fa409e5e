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

// The founder's clock is behind, by what the table says, and the joining peer has an edit of the right time.
class LateFounder : public WrongClock, public testing::WithParamInterface<std::int64_t> {};
TEST_P(LateFounder, ComesForwardToTheEditsOfWhoJoins) {
  leave_with(run("c"), "c", "OLD");
  Process b = run_ahead("b", -GetParam());
  ASSERT_TRUE(is_in_session("b") && add("b", "EARLY")) << b.out();
  Process c = run("c");
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  EXPECT_TRUE(wait_until([&] { return members_of("b") == 1 && has("b", "OLD") && has("c", "EARLY"); })) << b.out();
  EXPECT_TRUE(b.says("the session clock stepped forward", 5)) << b.out();
  ASSERT_TRUE(add("c", "NEW")) << c.out();
  ASSERT_TRUE(add("b", "NEWER")) << b.out();
  expect_one_world({"b", "c"}, {"OLD", "EARLY", "NEW", "NEWER"}, "the edits");
}
INSTANTIATE_TEST_SUITE_P(BehindBy_s, LateFounder, testing::Values(300, 7200), testing::PrintToStringParamName());

// Two members share a time that is too far behind: they follow nobody, and who joins says that its edits wait.
TEST_F(WrongClock, WhereNobodyComesForwardANewStartMakesEditsWork) {
  leave_with(run("c"), "c", "OLD");
  Process b = run_ahead("b", -7200), d = run_ahead("d", -7200);
  ASSERT_TRUE(wait_until([&] { return members_of("b") == 1 && members_of("d") == 1; })) << b.out() << d.out();
  Process c = run("c");
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  EXPECT_TRUE(c.says("has edits whose stamps are ahead of the session's time", 5)) << c.out();
  c.signal(SIGTERM);
  ASSERT_EQ(c.exit_code(10), 0) << c.out();
  Process again = run("c");
  ASSERT_TRUE(is_in_session("c")) << again.out() << again.err();
  ASSERT_TRUE(add("c", "NEW")) << again.out();
  EXPECT_TRUE(wait_until([&] { return has("b", "NEW") && has("d", "NEW"); })) << b.out() << again.out();
}

// The clock of the joining peer is behind, and its store has an edit of the right time.
TEST_F(WrongClock, OfWhoJoinsHidesNoEdits) {
  leave_with(run("c"), "c", "OLD");
  Process b = run("b");
  ASSERT_TRUE(is_in_session("b") && add("b", "EARLY")) << b.out();
  Process c = run_ahead("c", -7200);
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  EXPECT_TRUE(c.says("begins another log", 5)) << c.out();
  ASSERT_TRUE(wait_until([&] { return members_of("b") == 1; })) << c.out();
  ASSERT_TRUE(add("c", "NEW")) << c.out();
  ASSERT_TRUE(add("b", "NEWER")) << b.out();
  expect_one_world({"b", "c"}, {"OLD", "EARLY", "NEW", "NEWER"}, "the edits");
}

// A founder whose clock is behind, and whose store has edits of the right time, begins its session behind these.
TEST_F(WrongClock, AFounderBeginsBehindItsOwnEdits) {
  leave_with(run("b"), "b", "OLD");
  Process b = run_ahead("b", -7200);
  ASSERT_TRUE(is_in_session("b") && add("b", "NEW")) << b.out();
  Process c = run("c");
  ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
  ASSERT_TRUE(wait_until([&] { return members_of("b") == 1; })) << c.out();
  ASSERT_TRUE(add("c", "NEWER")) << c.out();
  expect_one_world({"b", "c"}, {"OLD", "NEW", "NEWER"}, "the edits");
}

}  // namespace peerd::stamp_process_test
