// How a daemon waits, asleep or polling, and how it continues after it has been stopped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <time.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "peerd/daemon/loop/cache_warmer.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "tests/net/listener.hpp"
#include "tests/net/wire.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::daemon_test {

using namespace std::chrono_literals;
using net::testing_support::Listener;
using net::testing_support::own_port;
using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kTicks = 40, kStrange = 40;

// A peer with 60 ticks a second, and a thread whose invalid datagrams it drops, one every 10 ms.
class Waiting : public testing::Test {
 protected:
  Waiting() {
    shared = std::move(*share_world(folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { }\n")));
    const config::PeerSettings settings{.name = "a", .id = 1};
    config::PeerObjects objects;
    objects.owned = {*shared->world.scene.find("CAR")};
    node = PeerNode::make(settings, {}, *shared, std::move(objects), {});
    transport = *net::MulticastSocket::open(io, clock, options());
  }
  [[nodiscard]] net::MulticastOptions options() const {
    return {.interface = "lo", .groups = {boost::asio::ip::make_address("239.192.80.0"), own_port(15)}};
  }
  [[nodiscard]] std::uint64_t dropped() const {
    std::uint64_t all = 0;
    for (const auto& [reason, count] : node->peer().counters().drops) all += count;
    return all;
  }

  struct Used {
    double wall_s, cpu_s;
    long sleeps;  // voluntary context switches
  };
  static Used used() {
    timespec wall{}, cpu{};
    clock_gettime(CLOCK_MONOTONIC, &wall);
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    const auto s = [](const timespec& t) {
      return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    return {s(wall), s(cpu), usage.ru_nvcsw};
  }

  // Runs until it has ticked and received enough, has answered requests meanwhile, and is asked to leave.
  Used run(Duration busy_poll) {
    Daemon daemon(
        io, *node, *transport, clock, [](const LogLine&) {}, std::nullopt);
    daemon.busy_poll(busy_poll, cache_warmer.get());
    Listener outsider(io, options());
    boost::asio::steady_timer timer(io);
    const auto give_up = std::chrono::steady_clock::now() + 10s;
    std::function<void()> each = [&] {
      outsider.send(0, "this is no datagram of a peer");
      const bool done = daemon.lateness().count() >= kTicks && dropped() >= kStrange;
      if (done || std::chrono::steady_clock::now() > give_up) {
        status = nlohmann::json::parse(daemon.on_control(R"({"do": "status"})").line);
        (void)daemon.on_control(R"({"do": "leave"})");
        return;
      }
      timer.expires_after(10ms);
      timer.async_wait([&](const boost::system::error_code& error) {
        if (!error) each();
      });
    };
    boost::asio::post(io, each);
    const Used before = used();
    EXPECT_EQ(daemon.run(), 0);
    const Used after = used();
    EXPECT_GE(daemon.lateness().count(), kTicks);
    EXPECT_GE(dropped(), kStrange);
    EXPECT_EQ(status["peer"]["name"], "a") << status;
    const Used all{after.wall_s - before.wall_s, after.cpu_s - before.cpu_s, after.sleeps - before.sleeps};
    EXPECT_LT(all.wall_s, 5.0) << "1.7 s, of which 1 s it listens before it ticks, and then it left at once";
    return all;
  }

  testing_support::ScratchFolder folder;
  boost::asio::io_context io{1};
  net::HostClock clock;
  std::unique_ptr<const SharedWorld> shared;
  std::unique_ptr<PeerNode> node;
  std::unique_ptr<net::Transport> transport;
  std::unique_ptr<CacheWarmer> cache_warmer = std::move(*CacheWarmer::make({}));
  std::uint64_t received_before = cache_warmer->updates_received();
  nlohmann::json status;
};

TEST_F(Waiting, SleepsAtOnceByDefault) {
  const Used all = run(Duration{0});
  EXPECT_GE(all.sleeps, static_cast<long>(kTicks));
  EXPECT_LT(all.cpu_s, 0.5 * all.wall_s);
  EXPECT_EQ(cache_warmer->updates_received(), received_before);
}

// The daemon polls for longer than the run takes, so it does everything while it polls.
TEST_F(Waiting, TicksHearsAnswersAndLeavesWhileItPolls) {
  const Used all = run(20s);
  EXPECT_LT(all.sleeps, static_cast<long>(kTicks) / 2);
  EXPECT_GT(cache_warmer->updates_received(), received_before + kTicks) << "some 80 could be between two ticks";
}

// 60 ticks, 100 timers and 100 datagrams a second: polling takes at most 0.26 of the time.
TEST_F(Waiting, SleepsWhenNothingHasComeForSoLong) {
  const Used all = run(1ms);
  EXPECT_GE(all.sleeps, static_cast<long>(kTicks));
  EXPECT_LT(all.cpu_s, 0.5 * all.wall_s);
}

net::MulticastOptions options_over(const char* interface) {
  return {.interface = interface, .groups = {boost::asio::ip::make_address("239.192.80.0"), own_port(14)}};
}

// A peer with all that it needs, and the lines of its log.
struct Peer {
  Peer(const SharedWorld& shared, const std::string& name, std::uint32_t id, const net::MulticastOptions& options) {
    const config::PeerSettings settings{.name = name, .id = id};
    node = PeerNode::make(settings, {}, shared, {}, {});
    transport = *net::MulticastSocket::open(io, clock, options);
    daemon = std::make_unique<Daemon>(
        io, *node, *transport, clock, [this](const LogLine& line) { said += line.text + '\n'; }, std::nullopt);
  }
  boost::asio::io_context io{1};
  net::HostClock clock;
  std::unique_ptr<PeerNode> node;
  std::unique_ptr<net::Transport> transport;
  std::unique_ptr<Daemon> daemon;
  std::string said;
};

// The other peer's last datagrams wait behind more than two reads take. The kernel's queue of 0.3 MB loses none of
// them.
TEST(Stalled, NobodyIsLostWhoseDatagramsWaitToBeRead) {
  const testing_support::ScratchFolder folder;
  const auto shared = std::move(*share_world(folder.write("w.wrl", "#VRML V2.0 utf8\n")));
  const net::MulticastOptions options = options_over("lo");
  Peer a(*shared, "a", 1, options), b(*shared, "b", 2, options);
  Listener outsider(a.io, options);
  boost::asio::steady_timer timer(a.io);
  const auto give_up = std::chrono::steady_clock::now() + 10s;
  bool stalled = false;
  std::function<void()> each = [&] {
    auto next = 10ms;
    if (stalled || std::chrono::steady_clock::now() > give_up) {
      (void)a.daemon->on_control(R"({"do": "leave"})");
      return;
    }
    if (a.said.contains("peer b (id 2) joined") && a.daemon->lateness().count() > 0) {
      stalled = true;
      for (int i = 0; i < 300; ++i) outsider.send(0, "this is no datagram of a peer");
      std::this_thread::sleep_for(2'500ms);
      next = 200ms;
    }
    timer.expires_after(next);
    timer.async_wait([&](const boost::system::error_code& error) {
      if (!error) each();
    });
  };
  boost::asio::post(a.io, each);
  std::thread goes_on([&] { (void)b.daemon->run(); });
  EXPECT_EQ(a.daemon->run(), 0);
  boost::asio::post(b.io, [&] { (void)b.daemon->on_control(R"({"do": "leave"})"); });
  goes_on.join();
  EXPECT_TRUE(stalled) << a.said;
  EXPECT_GT(a.daemon->lateness().most(), 2s);
  EXPECT_THAT(a.said, Not(HasSubstr("is lost")));
  EXPECT_THAT(b.said, HasSubstr("peer a (id 1) is lost")) << "as whoever is silent for 2.5 s";
}

// The daemon logs the change, and continues over the new interface by itself.
TEST(FollowsItsInterface, OneThatIsDeletedAndMadeAnew) {
  const testing_support::ScratchFolder folder;
  const auto shared = std::move(*share_world(folder.write("w.wrl", "#VRML V2.0 utf8\n")));
  with_wire([&](const Wire& wire) {
    wire.left.enter();
    Peer a(*shared, "a", 1, options_over("va"));
    boost::asio::steady_timer timer(a.io);
    const auto give_up = std::chrono::steady_clock::now() + 20s;
    bool deleted = false, made_anew = false;
    std::function<void()> each = [&] {
      if (!deleted && a.daemon->lateness().count() > 0) {
        deleted = shell("ip link del va");
      } else if (!made_anew && a.said.contains("\"va\" is gone")) {
        made_anew = wire.connect().empty();
      }
      if (a.said.contains("\"va\" is another one by now") || std::chrono::steady_clock::now() > give_up) {
        (void)a.daemon->on_control(R"({"do": "leave"})");
        return;
      }
      timer.expires_after(10ms);
      timer.async_wait([&](const boost::system::error_code& error) {
        if (!error) each();
      });
    };
    boost::asio::post(a.io, each);
    EXPECT_EQ(a.daemon->run(), 0);
    EXPECT_TRUE(made_anew);
    EXPECT_THAT(a.said, HasSubstr("\"va\" is another one by now"));
  });
}

}  // namespace peerd::daemon_test
