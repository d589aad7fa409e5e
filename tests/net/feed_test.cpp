// Real peers, of which one gets poses of its object from a program in real time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "peerd/peer/node/peer_log.hpp"
#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"

namespace peerd::feed_test {

using net::testing_support::own_port;
using testing::HasSubstr;
using testing_support::Process;

// The example, with the scenario that it comes with.
class Example : public testing_support::ControlledPeers, public testing::WithParamInterface<const char*> {
 protected:
  Process start_peer(const std::string& name) const {
    return Process(folder, name, PEERD_PROGRAM,
                   {"run", "--config", PEERD_SOURCE_DIR "/configs/scenarios/outside.toml", "--set",
                    "peer.a.feed.udp=127.0.0.1:0", "--peer", name, "--interface", "lo", "--port",
                    std::to_string(own_port(15)), "--record", record_of(name), "--control", socket_of(name)});
  }
  // The port that the system gave the peer.
  static std::uint16_t port_of(Process& peer) {
    EXPECT_TRUE(peer.says("takes poses by UDP at 127.0.0.1 port ", 5)) << peer.out() << peer.err();
    std::smatch found;
    const std::string out = peer.out();
    if (!std::regex_search(out, found, std::regex("at 127.0.0.1 port ([0-9]+)"))) return 0;
    return static_cast<std::uint16_t>(std::stoi(found[1]));
  }
  // Waits until the start, from which on logs are kept.
  void meet(Process& a, Process& b) {
    ASSERT_TRUE(a.says("peer b (id 2) joined", 5)) << a.out() << a.err();
    ASSERT_TRUE(b.says("peer a (id 1) joined", 5)) << b.out() << b.err();
    EXPECT_TRUE(wait_until([&] {
      const nlohmann::json since = ask("b", {{"do", "status"}})["since_start_s"];
      return since.is_number() && since >= 0;
    })) << a.out()
        << b.out();
  }
  PeerLog end(Process& peer, const std::string& name) {
    peer.signal(SIGTERM);
    EXPECT_EQ(peer.exit_code(5), 0) << peer.out() << peer.err();
    auto log = load_peer_log(record_of(name));
    EXPECT_TRUE(log.has_value());
    return log.value_or(PeerLog{});
  }
  [[nodiscard]] std::string record_of(const std::string& name) const { return (folder / (name + ".rows")).string(); }
  [[nodiscard]] std::string socket_of(const std::string& name) const { return (folder / (name + ".sock")).string(); }
};

TEST_P(Example, DrivesTheCarOfItsScenario) {
  const std::string python = PEERD_PYTHON;
  ASSERT_FALSE(python.empty()) << "the example is Python; scripts/test installs it";
  Process a = start_peer("a"), b = start_peer("b");
  const std::uint16_t port = port_of(a);
  ASSERT_NE(port, 0);
  meet(a, b);
  const bool by_socket = std::string(GetParam()) == "Socket";
  Process program(folder, "program", python,
                  {PEERD_SOURCE_DIR "/examples/feed_poses.py", "--seconds", "2", by_socket ? "--socket" : "--udp",
                   by_socket ? socket_of("a") : "127.0.0.1:" + std::to_string(port)});
  EXPECT_EQ(program.exit_code(10), 0) << program.err();
  EXPECT_EQ(program.err(), "");
  EXPECT_GT(ask("a", {{"do", "status"}})["counters"]["poses_taken"], 20);
  (void)end(a, "a");
  const PeerLog of_b = end(b, "b");
  EXPECT_THAT(a.out(), HasSubstr("refused 0 and 0 messages"));

  // The distance of a ghost from the nearest point of the figure eight.
  const auto off_m = [](const Vec3& p) {
    double least = 1e9;
    for (double w = 0.0; w < 6.3; w += 0.001) {
      least = std::min(least, (Vec3(6.0 * std::sin(w), 0.0, 3.0 * std::sin(2.0 * w)) - p).norm());
    }
    return least;
  };
  double way_m = 0.0, worst_m = 0.0;
  int moving = 0;
  std::optional<Vec3> last;
  for (const PeerLog::ObjectSample& belief : of_b.object_samples) {
    if (belief.owner != PeerId{1} || belief.state.velocity.isZero(0.0)) continue;
    ++moving;
    worst_m = std::max(worst_m, off_m(belief.state.position));
    if (last) way_m += (belief.state.position - *last).norm();
    last = belief.state.position;
  }
  EXPECT_GT(moving, 60);
  EXPECT_GT(way_m, 5.0) << "2 s at 5 m/s and less";
  EXPECT_LT(worst_m, 1.0) << "the threshold, and what it coasts when the program is over";
}
INSTANTIATE_TEST_SUITE_P(By, Example, testing::Values("Udp", "Socket"),
                         [](const auto& c) { return std::string(c.param); });

}  // namespace peerd::feed_test
