#include "peerd/daemon/open/run_flags.hpp"

#include <gmock/gmock.h>

namespace peerd::run_flags_test {

using testing::Contains;
using testing::ElementsAre;
using testing::StartsWith;

TEST(RunFlags, DescribeAPeerWithoutAConfiguration) {
  PeerOptions options;
  options.sets = {"seed=3"};
  const auto sets = as_settings(
      {.world = "/a \"b\".wrl", .name = "ada", .interface = "lo", .id = 5, .port = 99, .owns = {"CAR"}}, options);
  EXPECT_THAT(sets, ElementsAre(R"(world="/a \"b\".wrl")", "peer.ada.id=5", R"(peer.ada.owns=["CAR"])",
                                R"(transport.interface="lo")", "transport.port=99", "seed=3"))
      << "what somebody sets counts last";
  EXPECT_EQ(options.peer, "ada");
  EXPECT_FALSE(options.keeps_id);
}

TEST(RunFlags, GiveAPeerWithoutANumberOneThatNobodyElseHas) {
  PeerOptions one, other;
  const auto first = as_settings({.world = "/w.wrl"}, one), second = as_settings({.world = "/w.wrl"}, other);
  EXPECT_TRUE(one.keeps_id);
  EXPECT_EQ(one.peer, "peer");
  EXPECT_THAT(first, Contains(StartsWith("peer.peer.id=")));
  EXPECT_NE(first, second);
}

TEST(RunFlags, SayNothingOfAPeerThatAConfigurationHas) {
  PeerOptions options{.config = "c.toml", .peer = "b"};
  EXPECT_THAT(as_settings({.key = "/k", .open = false}, options), ElementsAre(R"(transport.key_file="/k")"));
  EXPECT_THAT(as_settings({.open = true}, options), ElementsAre("transport.sealed=false"));
  EXPECT_THAT(as_settings({.password = "-"}, options), ElementsAre(R"(transport.password_file="-")"));
  EXPECT_THAT(as_settings({.nats = {"nats://one", "tls://two"}}, options),
              ElementsAre(R"(transport.nats=["nats://one","tls://two"])"));
  EXPECT_EQ(options.peer, "b");
}

TEST(RunFlags, OfTheNetworkAlone) {
  EXPECT_THAT(network_settings({}), testing::IsEmpty());
  EXPECT_THAT(network_settings({.group = "ff15::1", .port = 5}),
              ElementsAre(R"(transport.group="ff15::1")", "transport.port=5"));
}

}  // namespace peerd::run_flags_test
