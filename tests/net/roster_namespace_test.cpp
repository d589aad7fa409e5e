// The real program with a roster, between two network namespaces as between two computers.
#include <gmock/gmock.h>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::roster_namespace_test {

using net::testing_support::own_port;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;

// Anna leads, bo edits, cy looks. Each is a user of their own.
class RosterOfAWorld : public testing_support::ControlledPeers {
 protected:
  [[nodiscard]] Process run(const std::string& name) const {
    return start(
        name, {"run", "--store", "", "--world", (folder / "town.wrl").string(), "--port", std::to_string(own_port(14))},
        name);
  }
  [[nodiscard]] Process join(const std::string& name, const std::string& invitation) const {
    return start(name, {"join", "--store", "", "--invite", invitation}, name);
  }
  // Runs a command that ends well, and returns what it prints.
  std::string output(const std::string& user, const std::vector<std::string>& words) const {
    Process command(folder, "command", PEERD_PROGRAM, words, user);
    EXPECT_EQ(command.exit_code(10), 0) << command.err();
    std::string out = command.out();
    if (out.ends_with('\n')) out.pop_back();
    return out;
  }
};

TEST_F(RosterOfAWorld, SaysWhoReadsAndWhoWrites) {
  with_wire([&](const Wire& wire) {
    folder.write("town.wrl", "#VRML V2.0 utf8\nDEF BOX Transform { children Shape { geometry Box { } } }\n");
    (void)output("anna", {"members", "town", "--begin", "anna"});
    (void)output("anna", {"members", "town", "--add", "bo=" + output("bo", {"keygen"})});
    (void)output("anna", {"members", "town", "--role", "observer", "--add", "cy=" + output("cy", {"keygen"})});
    const std::string invitation =
        output("anna", {"invite", "town"}).substr(std::string("peerd join --invite ").size());
    wire.left.enter();
    Process anna = run("anna");
    ASSERT_TRUE(is_in_session("anna")) << anna.out() << anna.err();
    wire.right.enter();
    Process bo = join("bo", invitation), cy = join("cy", invitation);
    ASSERT_TRUE(is_in_session("bo") && is_in_session("cy")) << bo.out() << bo.err() << cy.out() << cy.err();
    Process outsider(folder, "outsider", PEERD_PROGRAM, {"join", "--invite", invitation}, "dora");
    EXPECT_EQ(outsider.exit_code(10), 2);
    EXPECT_THAT(outsider.err(), HasSubstr("this user is no member"));

    ASSERT_TRUE(add("anna", "BALL") && add("bo", "CONE"));
    EXPECT_TRUE(wait_until([&] { return world_of("cy") == world_of("anna"); }));
    EXPECT_THAT(world_of("cy"), testing::AllOf(HasSubstr("BALL"), HasSubstr("CONE")));
    const auto refused = ask("cy", {{"do", "add"}, {"text", "DEF NOTE Transform { }"}});
    EXPECT_THAT(refused.dump(), HasSubstr("may only look"));

    // Bo is no member any more. It runs on, and hears all that is sent.
    (void)output("anna", {"members", "town", "--remove", "bo"});
    EXPECT_TRUE(wait_until([&] { return members_of("anna") == 1 && members_of("cy") == 1; }));
    EXPECT_TRUE(bo.says("no member of \"town\" any more", 10)) << bo.out();
    ASSERT_TRUE(add("anna", "SECRET"));
    EXPECT_TRUE(wait_until([&] { return world_of("cy") == world_of("anna"); }));
    EXPECT_THAT(world_of("cy"), testing::AllOf(HasSubstr("SECRET"), HasSubstr("CONE")));
    EXPECT_THAT(world_of("bo"), Not(HasSubstr("SECRET")));
    EXPECT_GT(ask("bo", {{"do", "status"}}).at("counters").at("net.in_other_epoch").get<int>(), 0);

    // A member that was away comes back with the roster that it had, and is given the newest.
    cy.signal(SIGTERM);
    ASSERT_EQ(cy.exit_code(10), 0);
    Process dora_key(folder, "dora", PEERD_PROGRAM, {"keygen"}, "dora");
    ASSERT_EQ(dora_key.exit_code(10), 0);
    const std::string key = dora_key.out().substr(0, dora_key.out().size() - 1);
    (void)output("anna", {"members", "town", "--add", "dora=" + key});
    EXPECT_TRUE(anna.says("epoch 5", 10)) << anna.out();
    Process back = run("cy");
    EXPECT_TRUE(back.says("epoch 5", 10)) << back.out();
    EXPECT_TRUE(wait_until([&] { return world_of("cy").find("SECRET") != std::string::npos; })) << back.out();
  });
}

}  // namespace peerd::roster_namespace_test
