#include "peerd/net/os/service_manager.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <regex>

#include "tests/must.hpp"
#include "tests/peerd/net/os/notified.hpp"

namespace peerd::net::service_manager_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::Notified;

TEST(ServiceManager, IsNoneWithoutItsSocket) {
  unsetenv("NOTIFY_SOCKET");
  setenv("WATCHDOG_USEC", "1000000", 1);
  const auto manager = ServiceManager::of_environment();
  EXPECT_FALSE(manager.is_there());
  EXPECT_FALSE(manager.watches_for());
  EXPECT_TRUE(manager.ready());
  EXPECT_TRUE(manager.status("nobody reads it"));
}

TEST(ServiceManager, GetsTheMessagesOfSdNotify) {
  const Notified notified;
  setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
  const auto manager = ServiceManager::of_environment();
  EXPECT_TRUE(manager.is_there());
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr) << "children do not speak for this process";
  EXPECT_TRUE(manager.ready());
  EXPECT_TRUE(manager.alive());
  EXPECT_TRUE(manager.status("two\nlines"));
  EXPECT_TRUE(manager.stopping());
  EXPECT_THAT(notified.messages(), ElementsAre("READY=1", "WATCHDOG=1", "STATUS=two lines", "STOPPING=1"));
  EXPECT_TRUE(manager.reloading());
  const auto message = only(notified.messages());
  EXPECT_TRUE(std::regex_match(message, std::regex("RELOADING=1\nMONOTONIC_USEC=[1-9][0-9]*"))) << message;
}

TEST(ServiceManager, SaysForHowLongItWatches) {
  const Notified notified;
  const auto watched_by = [&](const std::string& process) {
    setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "2500000", 1);
    setenv("WATCHDOG_PID", process.c_str(), 1);
    return ServiceManager::of_environment().watches_for();
  };
  EXPECT_EQ(watched_by(std::to_string(getpid())), Duration(std::chrono::milliseconds(2500)));
  EXPECT_EQ(watched_by("1"), std::nullopt) << "another process is watched";
  unsetenv("WATCHDOG_USEC");
  unsetenv("WATCHDOG_PID");
}

TEST(ServiceManager, ThatHasGoneIsAnErrorWithASentence) {
  {
    const Notified notified;
    setenv("NOTIFY_SOCKET", notified.path().c_str(), 1);
  }
  EXPECT_THAT(error_of(ServiceManager::of_environment().ready()),
              IsError(3, HasSubstr("can't reach the service manager at ")));
}

}  // namespace
}  // namespace peerd::net::service_manager_test
