#include "peerd/net/os/forward_time.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace peerd::net::forward_time_test {

using namespace std::chrono_literals;

TEST(ForwardTime, NeverRunsBackwardsAndSaysHowOftenItWouldHave) {
  ForwardTime time;
  EXPECT_EQ(time(HostTime{-5s}), HostTime{-5s}) << "any time may be the first";
  EXPECT_EQ(time(HostTime{10s}), HostTime{10s});
  EXPECT_EQ(time(HostTime{10s}), HostTime{10s});
  EXPECT_EQ(time.count(), 0u);
  EXPECT_EQ(time(HostTime{8s}), HostTime{10s});
  EXPECT_EQ(time(HostTime{9s}), HostTime{10s});
  EXPECT_EQ(time(HostTime{11s}), HostTime{11s});
  EXPECT_EQ(time.count(), 2u);
  EXPECT_EQ(time.most(), 2s);
}

}  // namespace peerd::net::forward_time_test
