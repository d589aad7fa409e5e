#include "peerd/net/transport/multicast_probe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::multicast_probe_test {

using testing::HasSubstr;
using testing_support::clock;
using testing_support::own_port;

TEST(MulticastProbe, FindsWhatDoctorTells) {
  const MulticastOptions options{.interface = "lo", .groups = {asio::ip::make_address("239.192.4.0"), own_port(1)}};
  asio::io_context io;
  const asio::ip::udp::socket greedy(io, {asio::ip::udp::v4(), own_port(1)});  // the peers' port is not the probe's
  const auto probe = must(probe_multicast(clock(), options));
  EXPECT_EQ(probe.over.interface.name, "lo");
  EXPECT_TRUE(probe.stamped);
  EXPECT_GT(probe.took, Duration{0});
  EXPECT_EQ(probe.memberships_max, memberships_limit(IpFamily::kV4));
}

TEST(MulticastProbe, NoPeerReceivesIt) {
  asio::io_context io;
  const MulticastOptions options{.interface = "lo", .groups = {asio::ip::make_address("239.192.4.0"), own_port(2)}};
  testing_support::Listener peer(io, options);
  peer.join(0);
  ASSERT_TRUE(probe_multicast(clock(), options));
  peer.send(0, "marker");
  ASSERT_TRUE(testing_support::run_until(io, [&] { return !peer.heard.empty(); }));
  EXPECT_EQ(peer.heard.front().second, "marker");
}

TEST(MulticastProbe, TheSettingsOfOwnDatagramsDoNotMatter) {
  const MulticastOptions options{.interface = "lo",
                                 .groups = {asio::ip::make_address("239.192.4.0"), own_port(1)},
                                 .receives_own_datagrams = false};  // as peers have it
  EXPECT_TRUE(probe_multicast(clock(), options));
}

TEST(MulticastProbe, AnErrorOfTheSocketIsTheProbesError) {
  const MulticastOptions options{.interface = "nosuch9",
                                 .groups = {asio::ip::make_address("239.192.4.0"), own_port(1)}};
  EXPECT_THAT(error_of(probe_multicast(clock(), options)),
              IsError(NetError::Kind::kNoSuchInterface, HasSubstr("nosuch9")));
}

}  // namespace peerd::net::multicast_probe_test
