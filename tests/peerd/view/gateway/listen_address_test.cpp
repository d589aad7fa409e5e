#include "peerd/view/gateway/listen_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::gateway::listen_address_test {

using testing::HasSubstr;

TEST(ListenAddress, IsAnAddressAndAPort) {
  EXPECT_EQ(listen_address("127.0.0.1:8080", false)->port(), 8080);
  EXPECT_EQ(listen_address("127.0.0.1:0", false)->address().to_string(), "127.0.0.1");
  EXPECT_EQ(listen_address("[::1]:65535", false)->address().to_string(), "::1");
  EXPECT_EQ(listen_address("127.9.9.9:1", false)->port(), 1);
  for (const char* wrong : {"", "8080", ":8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:65536",
                            "127.0.0.1:-1", "localhost:8080", "::1:8080", "[127.0.0.1]:1", "[::1]", "town"}) {
    const auto at = listen_address(wrong, true);
    ASSERT_FALSE(at) << wrong;
    EXPECT_EQ(at.error().exit_code, 2);
  }
}

TEST(ListenAddress, OtherComputersAreLetInByNameAlone) {
  for (const char* open : {"0.0.0.0:80", "192.168.1.1:80", "[::]:80", "[fe80::1]:80"}) {
    const auto at = listen_address(open, false);
    ASSERT_FALSE(at) << open;
    EXPECT_THAT(at.error().text, HasSubstr("gateway.beyond_loopback = true"));
    EXPECT_TRUE(listen_address(open, true)) << open;
  }
}

}  // namespace peerd::gateway::listen_address_test
