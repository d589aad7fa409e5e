// Real peers, of which one gets poses of its object from a program in real time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "peerd/peer/node/peer_log.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/process.hpp"

namespace peerd::feed_test {

using net::testing_support::own_port;
using testing::HasSubstr;
using testing_support::Process;
using Words = std::vector<std::string>;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR Transform { children Shape { geometry Box { } } }
)";
constexpr const char* kScenario = R"(world = "w.wrl"
[replication]
error_threshold_m = 0.05
[peer.a]
id = 1
owns = ["CAR"]
clock_offset_s = 3
[peer.a.motion.CAR]
outside = true
[peer.a.feed]
udp = "127.0.0.1:0"
[peer.b]
id = 2
)";

// The position on a circle at 3 m/s, by Unix time.
constexpr double kRadius = 2.0, kOmega = 1.5;
Vec3 circle(double unix_s) {
  const double a = kOmega * std::fmod(unix_s, 2.0 * std::numbers::pi / kOmega);
  return {kRadius * std::cos(a), 0.0, -kRadius * std::sin(a)};
}
double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class Feed : public testing::Test {
 protected:
  Process start_peer(const std::string& scenario, const std::string& name, unsigned slot) {
    return Process(
        folder, name, PEERD_PROGRAM,
        {"run", "--config", scenario, "--set", "peer.a.feed.udp=127.0.0.1:0", "--peer", name, "--interface", "lo",
         "--port", std::to_string(own_port(slot)), "--record", record_of(name), "--control", socket_of(name)});
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
    for (int tries = 0; tries < 200; ++tries) {
      const nlohmann::json since = ask("b", {"status"})["since_start_s"];
      if (since.is_number() && since >= 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    FAIL() << "no start: " << a.out() << b.out();
  }
  PeerLog end(Process& peer, const std::string& name) {
    peer.signal(SIGTERM);
    EXPECT_EQ(peer.exit_code(5), 0) << peer.out() << peer.err();
    auto log = load_peer_log(record_of(name));
    EXPECT_TRUE(log.has_value());
    return log.value_or(PeerLog{});
  }
  nlohmann::json ask(const std::string& peer, Words words) {
    words.insert(words.begin(), {"ctl", "--control", socket_of(peer), "--json"});
    Process ctl(folder, "ctl" + std::to_string(++calls), PEERD_PROGRAM, words);
    EXPECT_EQ(ctl.exit_code(10), 0) << ctl.err();
    return nlohmann::json::parse(ctl.out(), nullptr, false);
  }
  [[nodiscard]] std::string record_of(const std::string& name) const { return (folder / (name + ".rows")).string(); }
  [[nodiscard]] std::string socket_of(const std::string& name) const { return (folder / (name + ".sock")).string(); }

  testing_support::ScratchFolder folder;
  int calls = 0;
};

// The median error of the rows of that interval. A maximum would be spoilt by a sender that the system delays.
double median_error_m(const PeerLog& log, double from_s, double until_s) {
  std::vector<double> errors;
  for (const PeerLog::ObjectSample& b : log.object_samples) {
    const double t = to_seconds(b.true_at.time_since_epoch());
    if (t > from_s && t < until_s) errors.push_back((b.state.position - circle(t)).norm());
  }
  EXPECT_GT(errors.size(), 30u);
  if (errors.empty()) return 1e9;
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  return errors[errors.size() / 2];
}

TEST_F(Feed, ARemoteGhostFollowsAProgramsPosesByUdp) {
  folder.write("w.wrl", kWorld);
  const std::string scenario = folder.write("s.toml", kScenario).string();
  Process a = start_peer(scenario, "a", 14), b = start_peer(scenario, "b", 14);
  const std::uint16_t port = port_of(a);
  ASSERT_NE(port, 0);
  meet(a, b);

  namespace asio = boost::asio;
  asio::io_context io;
  asio::ip::udp::socket program(io, asio::ip::udp::v4());
  program.connect({asio::ip::address_v4::loopback(), port});
  const double begin = unix_now_s();
  double now = begin;
  for (; now < begin + 2.0; now = unix_now_s()) {
    const Vec3 p = circle(now);
    const nlohmann::json pose = {
        {"do", "pose"}, {"object", "CAR"}, {"position_m", {p.x(), p.y(), p.z()}}, {"time_s", now}};
    program.send(asio::buffer(pose.dump()));
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
  }
  program.send(asio::buffer(std::string("rubbish")));
  ASSERT_TRUE(a.says("a datagram that is no message of poses", 2));
  EXPECT_THAT(a.out(), HasSubstr("a program moves CAR"));
  EXPECT_TRUE(a.says("CAR stands still: the program that moves it is silent", 5));

  const auto objects = ask("b", {"objects"})["objects"];
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0]["own"], false);
  const Vec3 at(objects[0]["position_m"][0], objects[0]["position_m"][1], objects[0]["position_m"][2]);
  EXPECT_GT(at.norm(), 1.0) << "it stood at the origin before";
  EXPECT_GT(ask("a", {"status"})["counters"]["poses_taken"], 20);

  const PeerLog of_a = end(a, "a"), of_b = end(b, "b");
  EXPECT_THAT(a.out(), HasSubstr(" poses, refused 0 and 1 messages; 1 silences"));
  // The bound of pose_feed.hpp for 30 Hz is 0.3 mm; an object that stopped between poses would be off by 50 mm.
  EXPECT_LT(median_error_m(of_a, begin + 0.2, now - 0.05), 0.002);
  EXPECT_LT(median_error_m(of_b, begin + 0.2, now - 0.05), 0.05) << "the threshold";
}

// The example, with the scenario that it comes with.
class Example : public Feed, public testing::WithParamInterface<const char*> {};
TEST_P(Example, DrivesTheCarOfItsScenario) {
  const std::string python = PEERD_PYTHON;
  ASSERT_FALSE(python.empty()) << "the example is Python; scripts/test installs it";
  const std::string scenario = PEERD_SOURCE_DIR "/configs/scenarios/outside.toml";
  Process a = start_peer(scenario, "a", 15), b = start_peer(scenario, "b", 15);
  const std::uint16_t port = port_of(a);
  ASSERT_NE(port, 0);
  meet(a, b);
  const bool by_socket = std::string(GetParam()) == "Socket";
  Process program(folder, "program", python,
                  {PEERD_SOURCE_DIR "/examples/feed_poses.py", "--seconds", "2", by_socket ? "--socket" : "--udp",
                   by_socket ? socket_of("a") : "127.0.0.1:" + std::to_string(port)});
  EXPECT_EQ(program.exit_code(10), 0) << program.err();
  EXPECT_EQ(program.err(), "");
  EXPECT_GT(ask("a", {"status"})["counters"]["poses_taken"], 20);
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
