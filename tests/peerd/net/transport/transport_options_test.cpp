#include "peerd/net/transport/transport_options.hpp"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::net::transport_options_test {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(TransportOptions, AreThoseOfTheConfiguration) {
  const TransportSettings settings{.interface = "eth7",
                                   .group = "239.192.7.0",
                                   .group_pool = 9,
                                   .port = 5000,
                                   .ttl = 3,
                                   .dscp = 46,
                                   .receive_buffer_bytes = 4096,
                                   .multicast = kMulticastNever,
                                   .peers = {"192.0.2.7:47474"}};
  const auto options = must(transport_options(settings, {1, 2}));
  const MulticastOptions& m = options.multicast;
  EXPECT_EQ(m.interface, "eth7");
  EXPECT_EQ(m.groups.base.to_string(), "239.192.7.0");
  EXPECT_EQ(m.groups.port, 5000);
  EXPECT_EQ(m.groups.pool, 9u);
  EXPECT_EQ(m.ttl, 3);
  EXPECT_EQ(m.dscp, 46);
  EXPECT_EQ(m.receive_buffer_bytes, 4096);
  EXPECT_FALSE(m.receives_own_datagrams);
  EXPECT_FALSE(m.any_port);
  EXPECT_EQ(options.use, MulticastUse::kNever);
  EXPECT_THAT(options.peers, ElementsAre("192.0.2.7:47474"));
  EXPECT_EQ(options.key.k0, 1u);
  EXPECT_EQ(options.key.k1, 2u);
}

TEST(TransportOptions, HaveDefaults) {
  const auto options = must(transport_options({}, {}));
  EXPECT_EQ(options.multicast.groups.port, 47474);
  EXPECT_EQ(options.multicast.groups.base.to_string(), "239.192.80.0");
  EXPECT_EQ(options.use, MulticastUse::kAuto);
  TransportSettings always;
  always.multicast = kMulticastAlways;
  EXPECT_EQ(transport_options(always, {})->use, MulticastUse::kAlways);
}

TEST(TransportOptions, AGroupThatIsNoneIsAWrongConfiguration) {
  TransportSettings settings;
  settings.group = "192.0.2.1";
  EXPECT_THAT(error_of(transport_options(settings, {})),
              IsError(2, HasSubstr("error: 192.0.2.1 is not a multicast address")));
}

TEST(TransportOptions, ASmallerBufferThanRequestedIsAWarning) {
  TransportSettings settings;
  settings.receive_buffer_bytes = 1000;
  EXPECT_EQ(buffer_warning(settings, 1000), "");
  EXPECT_EQ(buffer_warning(settings, 999),
            "the kernel grants a receive buffer of 999 bytes, not 1000: raise it (sysctl -w net.core.rmem_max=1000) or "
            "lower transport.receive_buffer_bytes");
}

// Debian's kernels grant a fifth of it: without the file, each start of a peer would begin with the warning.
TEST(TransportOptions, ThePackageLetsTheKernelGrantTheDefaultBuffer) {
  std::ifstream file(PEERD_SOURCE_DIR "/peerd/packaging/peerd-sysctl.conf");
  constexpr std::string_view kKey = "net.core.rmem_max = ";
  std::uint64_t most_bytes = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(kKey)) most_bytes = std::stoull(line.substr(kKey.size()));
  }
  EXPECT_GE(most_bytes, TransportSettings{}.receive_buffer_bytes);
}

}  // namespace peerd::net::transport_options_test
