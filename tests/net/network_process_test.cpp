// The real program where its network changes under it, or is not as it should be: between two network namespaces as
// between two computers.
#include <gmock/gmock.h>

#include <boost/asio/ip/tcp.hpp>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::network_process_test {

using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::Process;
using Words = std::vector<std::string>;

class Network : public testing_support::ControlledPeers {
 protected:
  Network() { folder.write("w.wrl", "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { } } }\n"); }

  Process run(const std::string& name, const Words& more = {}) const {
    Words words{"run",
                "--world",
                (folder / "w.wrl").string(),
                "--world-name",
                world,
                "--port",
                std::to_string(own_port(12)),
                "--store",
                (folder / (name + ".store")).string()};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  Process join(const std::string& name, const Words& more = {}) const {
    Words words{"join", world, "--store", (folder / (name + ".store")).string()};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  // The words of a command that ends by itself.
  [[nodiscard]] std::string output(const Words& words) const {
    Process command(folder, "command", PEERD_PROGRAM, words);
    EXPECT_GE(command.exit_code(10), 0);
    return command.out() + command.err();
  }
  [[nodiscard]] std::string troubles_of(const std::string& name) const {
    const json status = ask(name, {{"do", "status"}});
    return status.is_object() ? status.value("troubles", json::array()).dump() : "";
  }
  // The answer of the gateway from which a page gets what it shows.
  [[nodiscard]] static std::string fetched(std::uint16_t port, const std::string& target) {
    boost::asio::ip::tcp::iostream gateway;
    gateway.expires_after(std::chrono::seconds(10));
    gateway.connect("127.0.0.1", std::to_string(port));
    gateway << "GET " << target << " HTTP/1.1\r\nHost: 127.0.0.1:" << port << "\r\nConnection: close\r\n\r\n"
            << std::flush;
    std::ostringstream answer;
    answer << gateway.rdbuf();
    return answer.str();
  }

  const std::string world = "network-" + std::to_string(getpid());
};

TEST_F(Network, WhoJoinsFindsAPeerWhoseAddressHasChanged) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    Process a = run("a", {"--interface", "va"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    ASSERT_TRUE(shell("ip addr flush dev va scope global && ip addr add 192.0.2.77/24 dev va"));
    wire.right.enter();
    Process b = join("b", {"--interface", "vb"});
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    EXPECT_TRUE(a.says("to who joins, at 192.0.2.77", 5)) << a.out();
  });
}

TEST_F(Network, LinkLocalAddressesAreEnough) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip addr del 192.0.2.1/24 dev va"));
    Process a = run("a", {"--interface", "va", "--group", "ff15::50:0"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    wire.right.enter();
    ASSERT_TRUE(shell("ip addr del 192.0.2.2/24 dev vb"));
    Process b = join("b", {"--interface", "vb", "--ipv6"});
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    EXPECT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; }));
  });
}

TEST_F(Network, AnInterfaceThatIsMadeAnewIsFollowedByWhatAnswersToo) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    Process a = run("a", {"--interface", "va"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    ASSERT_TRUE(shell("ip link del va"));
    ASSERT_TRUE(a.says("is gone", 5)) << a.out();
    ASSERT_EQ(wire.connect(), "");
    ASSERT_TRUE(a.says("is another one by now", 5)) << a.out();
    wire.right.enter();
    EXPECT_THAT(output({"ls", "--interface", "vb"}), HasSubstr(world));
    Process b = join("b", {"--interface", "vb"});
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
  });
}

TEST_F(Network, AStoreInUseIsOfAPeerThatWorks) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    Process a = run("a", {"--interface", "va"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    const std::string said =
        output({"join", world, "--interface", "lo", "--store", (folder / "a.store").string(), "--control", ""});
    EXPECT_THAT(said, HasSubstr("a peer on this computer runs with the store"));
    EXPECT_THAT(said, HasSubstr("over lo"));
  });
}

TEST_F(Network, APeerOfBeforeTheNetworkGoesOverToIt) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    ASSERT_TRUE(shell("ip link set va down"));
    Process a = run("a");
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    EXPECT_THAT(troubles_of("a"), HasSubstr("reaches this computer only"));
    ASSERT_TRUE(add("a", "BALL"));
    Process c = join("c");
    ASSERT_TRUE(is_in_session("c")) << c.out() << c.err();
    ASSERT_TRUE(shell("ip link set va up"));
    ASSERT_TRUE(a.says("goes over from lo to va", 10)) << a.out();
    EXPECT_TRUE(c.says("goes over from lo to va", 10)) << c.out();
    wire.right.enter();
    Process b = join("b", {"--interface", "vb"});
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    EXPECT_TRUE(wait_until([&] { return members_of("a") == 2 && world_of("b") == world_of("a"); }));
    EXPECT_TRUE(wait_until([&] { return troubles_of("a") == "[]"; })) << troubles_of("a");
  });
}

// The left computer drops what comes from the right one's subnet, and hears nobody.
class OneWay : public Network, public testing::WithParamInterface<bool> {
 protected:
  // Peers are found in the folder of the test, as those of a user are; true: the sessions are open.
  void SetUp() override {
    std::filesystem::create_directory_symlink(".", folder / "peerd");
    if (const char* value = std::getenv("XDG_RUNTIME_DIR")) before_ = value;
    setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
  }
  void TearDown() override { before_ ? setenv("XDG_RUNTIME_DIR", before_->c_str(), 1) : unsetenv("XDG_RUNTIME_DIR"); }
  Process run_here(const std::string& name, const std::string& interface, Words more = {}) const {
    more.insert(more.begin(), {"--interface", interface});
    if (GetParam()) more.push_back("--open");
    return run(name, more);
  }

 private:
  std::optional<std::string> before_;
};
TEST_P(OneWay, ALinkThatGoesOneWayIsSaid) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    if (!shell("echo 1 > /proc/sys/net/ipv4/conf/va/rp_filter")) GTEST_SKIP() << "rp_filter can't be set here";
    wire.right.enter();
    ASSERT_TRUE(
        shell("echo 0 > /proc/sys/net/ipv4/conf/all/rp_filter; echo 0 > /proc/sys/net/ipv4/conf/vb/rp_filter; "
              "ip addr del 192.0.2.2/24 dev vb; ip addr add 198.51.100.2/24 dev vb; ip route add 192.0.2.0/24 dev vb"));
    wire.left.enter();
    Process a = run_here("a", "va");
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    wire.right.enter();
    Process b = run_here("b", "vb", {"--set", "gateway.listen=127.0.0.1:" + std::to_string(own_port(14))});
    ASSERT_TRUE(b.says("in session", 10)) << b.out() << b.err();
    EXPECT_TRUE(b.says(GetParam() ? "hears peer a (id " : "hears the peer of id ", 4)) << b.out();
    EXPECT_THAT(troubles_of("b"), HasSubstr("which hears nothing of this one"));
    EXPECT_THAT(output({"doctor", "--interface", "vb"}), HasSubstr("which hears nothing of this one"));
    EXPECT_THAT(fetched(own_port(14), "/api/v1/status"), HasSubstr("which hears nothing of this one")) << "the page";
    wire.left.enter();
    EXPECT_THAT(output({"doctor", "--interface", "va"}), HasSubstr("packets have been dropped so"));
  });
}
INSTANTIATE_TEST_SUITE_P(Sessions, OneWay, testing::Bool(),
                         [](const auto& each) { return each.param ? "Open" : "Sealed"; });

// TCP gets through, and no datagram does: none leaves a computer.
TEST_F(Network, AJoiningPeerThatHearsNothingSaysSo) {
  with_wire([&](const Wire& wire) {
    wire.right.enter();
    Process a = run("a", {"--interface", "vb", "--open", "--set", "transport.ttl=0", "--set",
                          "transport.snapshot_port=" + std::to_string(own_port(13))});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    wire.left.enter();
    Process b = start("b", {"join", world, "--open", "--interface", "va", "--store", "", "--from",
                            "192.0.2.2:" + std::to_string(own_port(13))});
    EXPECT_TRUE(b.says("hears no datagram of any peer", 8)) << b.out() << b.err();
    EXPECT_THAT(troubles_of("b"), HasSubstr("hears no datagram of any peer"));
  });
}

TEST_F(Network, WhereThereIsOnlyIpv6ItIsTaken) {
  with_wire([&](const Wire& wire) {
    wire.right.enter();
    ASSERT_TRUE(shell("ip addr del 192.0.2.2/24 dev vb && ip addr add 2001:db8::2/64 dev vb nodad"));
    wire.left.enter();
    ASSERT_TRUE(shell("ip addr del 192.0.2.1/24 dev va"));
    EXPECT_THAT(output({"run", "--world", (folder / "w.wrl").string(), "--interface", "va"}), HasSubstr("--ipv6"));
    ASSERT_TRUE(shell("ip addr add 2001:db8::1/64 dev va nodad"));
    Process a = run("a");
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    EXPECT_THAT(output({"doctor"}), HasSubstr("va is connected"));
    wire.right.enter();
    EXPECT_THAT(output({"ls"}), HasSubstr(world));
    Process b = join("b");
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    EXPECT_TRUE(wait_until([&] { return members_of("a") == 1; })) << a.out() << b.out();
  });
}

}  // namespace peerd::network_process_test
