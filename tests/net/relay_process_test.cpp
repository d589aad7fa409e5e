// The real program through real relays: islands of multicast and single peers, a relay that dies and comes back, a
// root that another one takes the place of, and an island that is cut off. An island is a multicast port on lo.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"

namespace peerd::relay_process_test {

using net::testing_support::own_port;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;

using Words = std::vector<std::string>;

class RelayProcess : public testing_support::ControlledPeers {
 protected:
  enum Slot : unsigned { kRoot, kSpare, kLeft, kRight, kLeftIsland, kRightIsland };

  void SetUp() override {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
  }
  [[nodiscard]] static std::string port_of(Slot slot) { return std::to_string(own_port(slot)); }
  [[nodiscard]] static std::string at(Slot slot) { return "127.0.0.1:" + port_of(slot); }

  // A relay of this user, who has the world's key once a peer has run.
  [[nodiscard]] std::unique_ptr<Process> relay(const std::string& name, Slot slot, const std::vector<Slot>& parents,
                                               std::optional<Slot> island = {}) const {
    Words words{"relay", "--port", port_of(slot), "--world", world};
    for (const Slot parent : parents) words.insert(words.end(), {"--parent", at(parent)});
    if (island) words.insert(words.end(), {"--island", "lo", "--group-port", port_of(*island)});
    return std::make_unique<Process>(folder, name, PEERD_PROGRAM, words);
  }
  [[nodiscard]] Process peer(const std::string& name, const Words& network) const {
    Words words{"run", "--world", (folder / "w.wrl").string(),           "--world-name",
                world, "--store", (folder / (name + ".store")).string(), "--take-over"};
    words.insert(words.end(), network.begin(), network.end());
    return start(name, words);
  }
  [[nodiscard]] Process on_island(const std::string& name, Slot island) const {
    return peer(name, {"--interface", "lo", "--port", port_of(island)});
  }
  [[nodiscard]] bool see_each_other(const Words& peers) const {
    return std::ranges::all_of(peers, [&](const auto& each) { return is_in_session(each); }) && wait_until([&] {
             return std::ranges::all_of(peers, [&](const auto& each) { return members_of(each) == peers.size() - 1; });
           });
  }

  const std::string world = "relay-" + std::to_string(getpid());
};

TEST_F(RelayProcess, IslandsAndASinglePeerShareAWorldWhateverRelayDies) {
  Process a = on_island("a", kLeftIsland);
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();  // and the world has a key
  auto root = relay("root", kRoot, {});
  const auto spare = relay("spare", kSpare, {kRoot});
  const auto left = relay("left", kLeft, {kRoot, kSpare}, kLeftIsland);
  auto right = relay("right", kRight, {kRoot, kSpare}, kRightIsland);
  Process b = on_island("b", kRightIsland);
  Process c = peer("c", {"--relay", at(kRoot), "--relay", at(kSpare)});
  const Words all{"a", "b", "c"};
  ASSERT_TRUE(see_each_other(all)) << a.out() << b.out() << c.out() << left->out();
  EXPECT_THAT(c.out(), AllOf(HasSubstr("relay " + at(kRoot)), HasSubstr("sealed"), Not(HasSubstr("no multicast"))));
  EXPECT_THAT(root->out(), HasSubstr("greetings are sealed"));
  ASSERT_TRUE(add("a", "A1") && add("b", "B1") && add("c", "C1"));
  expect_one_world(all, {"A1", "B1", "C1"}, "edits on each side");

  // The root dies without a word: the spare one is the root of all, and nothing is lost.
  root->signal(SIGKILL);
  ASSERT_TRUE(add("a", "A2") && add("b", "B2") && add("c", "C2"));
  expect_one_world(all, {"A2", "B2", "C2"}, "the root's death");
  EXPECT_TRUE(c.says("goes through relay " + at(kSpare), 5)) << c.out();

  // It comes back, and is the root again some time later.
  root = relay("root", kRoot, {});
  ASSERT_TRUE(wait_until([&] {
    return c.out().find("goes through relay " + at(kRoot) + " in place") != std::string::npos;
  })) << c.out();
  ASSERT_TRUE(add("a", "A3") && add("b", "B3") && add("c", "C3"));
  expect_one_world(all, {"A3", "B3", "C3"}, "the root's return");

  // An island is cut off, for so long that its peer is missed, and healed.
  right->signal(SIGKILL);
  ASSERT_TRUE(wait_until([&] { return members_of("b") == 0 && members_of("a") == 1; })) << a.out();
  ASSERT_TRUE(add("a", "A4") && add("b", "B4") && add("c", "C4"));
  EXPECT_THAT(world_of("b"), Not(HasSubstr("A4")));
  right = relay("right", kRight, {kRoot, kSpare}, kRightIsland);
  expect_one_world(all, {"A4", "B4", "C4"}, "the island's return");
}

TEST_F(RelayProcess, TheKeyOfARelayIsPrintedAndTaken) {
  Process a = peer("a", {"--relay", at(kRoot)});
  ASSERT_TRUE(a.says("relay " + at(kRoot), 20)) << a.out() << a.err();
  Process invite(folder, "invite", PEERD_PROGRAM, {"invite", world, "--relay"});
  ASSERT_EQ(invite.exit_code(20), 0) << invite.err();
  EXPECT_THAT(invite.out(), testing::MatchesRegex("peerd-relay-1:[A-Za-z0-9_-]+\n"));
  folder.write("relay.key", invite.out());
  std::filesystem::permissions(folder / "relay.key", std::filesystem::perms::owner_read);
  Process root(folder, "root", PEERD_PROGRAM,
               {"relay", "--port", port_of(kRoot), "--relay-key", (folder / "relay.key").string()});
  EXPECT_TRUE(a.says("goes through relay " + at(kRoot), 20)) << a.out() << root.out();
  root.signal(SIGTERM);
  EXPECT_EQ(root.exit_code(20), 0) << root.err();
  EXPECT_TRUE(a.says("no other one answers", 20)) << a.out();
}

TEST_F(RelayProcess, WrongUseIsASentence) {
  const auto error_of = [&](const Words& options) {
    Words words{"relay"};
    words.insert(words.end(), options.begin(), options.end());
    Process relay(folder, "wrong", PEERD_PROGRAM, words);
    EXPECT_EQ(relay.exit_code(20), 2) << relay.out();
    return relay.err();
  };
  EXPECT_THAT(error_of({}), HasSubstr("say whose greetings it takes"));
  EXPECT_THAT(error_of({"--open", "--world", "town"}), HasSubstr("say whose greetings it takes"));
  EXPECT_THAT(error_of({"--open", "--parent", "nowhere"}), HasSubstr("--parent: \"nowhere\" is no HOST:PORT"));
  EXPECT_THAT(error_of({"--open", "--mesh", "127.0.0.1:1"}), HasSubstr("--mesh-port"));
  EXPECT_THAT(error_of({"--open", "--group", "10.0.0.1"}), HasSubstr("is not a multicast address"));
  folder.write("no.key", "something else\n");
  std::filesystem::permissions(folder / "no.key", std::filesystem::perms::owner_read);
  EXPECT_THAT(error_of({"--relay-key", (folder / "no.key").string()}), HasSubstr("no line of peerd invite"));
}

}  // namespace peerd::relay_process_test
