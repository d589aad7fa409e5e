// The real program between two network namespaces, as between two computers: an invitation is all that one user gives
// to another.
#include <gmock/gmock.h>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::invitation_namespace_test {

using net::testing_support::own_port;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;

class InvitationOverAWire : public testing_support::ControlledPeers {
 protected:
  Process run(const std::string& name, const std::string& user) const {
    return start(
        name, {"run", "--store", "", "--world", (folder / "town.wrl").string(), "--port", std::to_string(own_port(13))},
        user);
  }
};

TEST_F(InvitationOverAWire, BringsSomebodyInByTwoCommandsAndNobodyElse) {
  with_wire([&](const Wire& wire) {
    folder.write("town.wrl", "#VRML V2.0 utf8\nDEF BOX Transform { children Shape { geometry Box { } } }\n");
    wire.left.enter();
    Process a = run("a", "alice");
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    Process invite(folder, "invite", PEERD_PROGRAM, {"invite", "town"}, "alice");
    ASSERT_EQ(invite.exit_code(10), 0) << invite.err();
    const std::string begin = "peerd join --invite ";
    ASSERT_THAT(invite.out(), testing::StartsWith(begin));
    const std::string invitation = invite.out().substr(begin.size(), invite.out().size() - begin.size() - 1);

    wire.right.enter();
    Process b = start("b", {"join", "--store", "", "--invite", invitation}, "bob");
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    // Somebody has the world's file, and a key of their own.
    Process c = run("c", "carol");
    ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
    for (Process* const each : {&a, &b, &c}) {
      EXPECT_TRUE(each->says("sends datagrams that this peer's key does not open", 10)) << each->out();
    }

    ASSERT_TRUE(add("a", "BALL") && add("b", "CONE"));
    EXPECT_TRUE(wait_until([&] { return world_of("a") == world_of("b"); }));
    EXPECT_THAT(world_of("a"), testing::AllOf(HasSubstr("BALL"), HasSubstr("CONE")));
    EXPECT_EQ(members_of("a"), 1u);
    EXPECT_EQ(members_of("b"), 1u);
    EXPECT_EQ(members_of("c"), 0u);
    EXPECT_THAT(world_of("c"), testing::AllOf(Not(HasSubstr("BALL")), Not(HasSubstr("CONE"))));
  });
}

}  // namespace peerd::invitation_namespace_test
