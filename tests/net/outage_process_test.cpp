// The real program where its network, its computer or its process fails for a while, in namespaces as between two
// computers.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <optional>
#include <thread>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"

namespace peerd::outage_process_test {

using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;
using Words = std::vector<std::string>;

class Outage : public testing_support::ControlledPeers {
 protected:
  Outage() { folder.write("w.wrl", "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { } } }\n"); }

  [[nodiscard]] Words run_words(const std::string& name, unsigned slot, const Words& more) const {
    Words words{"run",
                "--world",
                (folder / "w.wrl").string(),
                "--world-name",
                world,
                "--port",
                std::to_string(own_port(slot)),
                "--store",
                (folder / (name + ".store")).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Process run(const std::string& name, const Words& more, unsigned slot = 9) const {
    return start(name, run_words(name, slot, more));
  }
  // The same by a shell, which says its number in a file and becomes the peer.
  Process run_with_number(const std::string& name, const Words& more) const {
    Words words = run_words(name, 9, more);
    words.insert(words.begin(), {"-c", "echo $$ > " + number_file(name) + "; exec \"$0\" \"$@\"", PEERD_PROGRAM});
    words.insert(words.end(), {"--name", name, "--control", (folder / (name + ".sock")).string()});
    return Process(folder, name, "/bin/sh", words);
  }
  [[nodiscard]] std::string number_file(const std::string& name) const { return (folder / (name + ".pid")).string(); }
  [[nodiscard]] pid_t number_of(const std::string& name) const {
    return std::stoi(testing_support::text_of(number_file(name)));
  }
  [[nodiscard]] static std::size_t count(const std::string& text, const std::string& words) {
    std::size_t found = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
    return found;
  }

  const std::string world = "outage-" + std::to_string(getpid());
};

// Two have met through a third, which leaves for good. Of outages of more than ten minutes KnownPeers has a test.
TEST_F(Outage, TwoOfAUnicastMeshMeetAgainWithoutTheThird) {
  with_wire([&](const Wire& wire) {
    const auto unicast = [&](const char* interface) {
      return Words{"--interface", interface,
                   "--set",       "transport.multicast=never",
                   "--set",       "transport.peers=[\"192.0.2.1:" + std::to_string(own_port(10)) + "\"]"};
    };
    wire.left.enter();
    Process c = run("c", unicast("va"), 10), a = run("a", unicast("va"));
    wire.right.enter();
    Process b = run("b", unicast("vb"));
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 2 && members_of("b") == 2; })) << a.out() << b.out();
    c.signal(SIGTERM);
    ASSERT_EQ(c.exit_code(10), 0) << c.out();
    ASSERT_TRUE(shell("ip link set vb down"));
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 0 && members_of("b") == 0; })) << a.out() << b.out();
    ASSERT_TRUE(add("a", "BY_A") && add("b", "BY_B"));
    ASSERT_TRUE(shell("ip link set vb up"));
    EXPECT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out() << b.out();
    expect_one_world({"a", "b"}, {"BY_A", "BY_B"}, "the outage");
  });
}

TEST_F(Outage, APeerWithoutDescriptorsDoesNotSayThatItsInterfaceIsGone) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    Process a = run_with_number("a", {"--interface", "va"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    rlimit before{};
    ASSERT_EQ(prlimit(number_of("a"), RLIMIT_NOFILE, nullptr, &before), 0);
    const rlimit none{3, before.rlim_max};
    ASSERT_EQ(prlimit(number_of("a"), RLIMIT_NOFILE, &none, nullptr), 0);
    EXPECT_TRUE(a.says("cannot ask the system for interface \"va\": Too many open files", 5)) << a.out();
    EXPECT_THAT(a.out(), Not(HasSubstr("is gone")));
    ASSERT_EQ(prlimit(number_of("a"), RLIMIT_NOFILE, &before, nullptr), 0);
    EXPECT_TRUE(is_in_session("a")) << a.out();
    ASSERT_TRUE(shell("ip link del va"));
    EXPECT_TRUE(a.says("\"va\" is gone", 5)) << a.out();
  });
}

// Another program keeps the port by which peers are found. What the peer advises can be done.
TEST_F(Outage, APeerThatCannotBeFoundIsJoinedAsItAdvises) {
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    namespace asio = boost::asio;
    asio::io_context io;
    std::optional<asio::ip::udp::socket> taken(std::in_place, io, asio::ip::udp::endpoint(asio::ip::udp::v4(), 47473));
    ASSERT_EQ(fcntl(taken->native_handle(), F_SETFD, FD_CLOEXEC), 0);  // the peers inherit none
    Process a = run("a", {"--interface", "va"});
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    EXPECT_TRUE(a.says("join by the address that the log of a peer says (peerd join --from HOST:PORT)", 5)) << a.out();
    const std::string gives = " to who joins, at 192.0.2.1 port ", said = a.out();
    const auto at = said.find(gives);
    ASSERT_NE(at, std::string::npos) << said;
    const std::string port = std::to_string(std::stoi(said.substr(at + gives.size())));
    wire.right.enter();
    Process b = start("b", {"join", world, "--interface", "vb", "--store", "", "--from", "192.0.2.1:" + port});
    ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
    EXPECT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out() << b.out();
    taken.reset();
    EXPECT_TRUE(a.says("peerd ls and peerd join find it from now on", 5)) << a.out();
  });
}

// The kernel keeps the first datagrams of the stop, and has no room for the others.
TEST_F(Outage, AStopIsSaidOnce) {
  with_wire([&](const Wire& wire) {
    const Words small{"--set", "transport.receive_buffer_bytes=4096"};
    wire.left.enter();
    Words of_a{"--interface", "va"}, of_b{"--interface", "vb"};
    of_a.insert(of_a.end(), small.begin(), small.end());
    Process a = run("a", of_a);
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    wire.right.enter();
    Process b = run("b", of_b);
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out() << b.out();
    a.signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::seconds(9));
    a.signal(SIGCONT);
    ASSERT_TRUE(a.says("this peer was stopped for", 5)) << a.out();
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << a.out() << b.out();
    ASSERT_TRUE(add("b", "AFTER"));
    expect_one_world({"a", "b"}, {"AFTER"}, "the stop");
    EXPECT_EQ(count(a.out(), "this peer was stopped for"), 1u) << a.out();
    EXPECT_EQ(count(a.out(), " warning "), 1u) << a.out();
  });
}

}  // namespace peerd::outage_process_test
