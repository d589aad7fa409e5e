#include "peerd/daemon/loop/service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "tests/peerd/net/os/notified.hpp"

namespace peerd::service_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::Notified;

class ServiceOfPeer : public testing::Test {
 protected:
  // A watchdog of 40 ms: a sign of life every 10 ms.
  net::ServiceManager watched() const {
    setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "40000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    return net::ServiceManager::of_environment();
  }
  Service::Peer peer() {
    return {
        .status = [this] { return status; }, .ticks = [this] { return ticks; }, .every_second = [this] { ++turns; }};
  }
  void run_turns(int more) {
    io.restart();
    for (const int until = turns + more; turns < until;) io.run_one();
  }

  Notified notified;
  boost::asio::io_context io;
  std::vector<std::string> lines;
  std::string status = "alone";
  std::uint64_t ticks = 1;
  int turns = 0;
  std::function<void(const LogLine&)> log = [this](const LogLine& line) { lines.push_back(line.text); };
};

TEST_F(ServiceOfPeer, SaysThatItBeginsAndWhatItDoes) {
  Service service(io, watched(), peer(), log);
  EXPECT_TRUE(notified.messages().empty()) << "nothing before it has begun";
  service.begin();
  EXPECT_THAT(notified.messages(), ElementsAre("READY=1", "WATCHDOG=1", "STATUS=alone"));
  status = "two peers";
  run_turns(1);
  EXPECT_THAT(notified.messages(), ElementsAre("STATUS=two peers")) << "no tick, no sign of life";
  service.leave();
  EXPECT_THAT(notified.messages(), ElementsAre("STOPPING=1"));
  EXPECT_TRUE(lines.empty());
}

TEST_F(ServiceOfPeer, IsAliveOnlyWhileItTicks) {
  Service service(io, watched(), peer(), log);
  service.begin();
  (void)notified.messages();
  ++ticks;
  run_turns(1);
  EXPECT_THAT(notified.messages(), ElementsAre("WATCHDOG=1"));
  run_turns(3);
  EXPECT_TRUE(notified.messages().empty()) << "the loop turns, but the peer does nothing";
  ++ticks;
  run_turns(1);
  EXPECT_THAT(notified.messages(), ElementsAre("WATCHDOG=1"));
}

TEST_F(ServiceOfPeer, ReloadsBetweenTwoMessages) {
  Service service(io, watched(), peer(), log);
  std::vector<std::string> before;
  service.reload([&] { before = notified.messages(); });
  ASSERT_EQ(before.size(), 1u);
  EXPECT_THAT(before.front(), HasSubstr("RELOADING=1"));
  EXPECT_THAT(notified.messages(), ElementsAre("READY=1"));
}

TEST_F(ServiceOfPeer, WithoutAManagerOnlyTheOtherWorkIsDone) {
  unsetenv("NOTIFY_SOCKET");
  Service service(io, net::ServiceManager::of_environment(), peer(), log);
  service.begin();
  EXPECT_EQ(turns, 1);
  EXPECT_TRUE(notified.messages().empty());
}

TEST_F(ServiceOfPeer, AManagerThatHasGoneIsLoggedOnce) {
  std::optional<Notified> gone(std::in_place);
  setenv("NOTIFY_SOCKET", gone->path().c_str(), 1);
  Service service(io, net::ServiceManager::of_environment(), peer(), log);
  gone.reset();
  service.begin();
  service.leave();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines.front(), HasSubstr("can't reach the service manager"));
}

}  // namespace
}  // namespace peerd::service_test
