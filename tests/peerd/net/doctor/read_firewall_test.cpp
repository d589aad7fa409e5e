#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/net/doctor/host_facts.hpp"
#include "tests/net/wire.hpp"

namespace peerd::doctor::read_firewall_test {

using net::testing_support::shell;
using net::testing_support::Wire;
using net::testing_support::with_wire;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(ReadFirewall, NamesTheChainsThatDropByTheirPolicy) {
  if (!shell("nft --version >/dev/null")) GTEST_SKIP() << "no nft here (package nftables)";
  with_wire([](const Wire& wire) {
    wire.left.enter();
    EXPECT_TRUE(read_firewall().readable);
    EXPECT_THAT(read_firewall().dropping, IsEmpty());
    const auto add_chain = [](const std::string& name, const std::string& hook, const std::string& policy) {
      return shell("nft 'add chain inet filter " + name + " { type filter hook " + hook + " priority 0; policy " +
                   policy + "; }'");
    };
    ASSERT_TRUE(shell("nft add table inet filter"));
    ASSERT_TRUE(add_chain("accepts", "input", "accept") && add_chain("leaves", "output", "drop"));
    EXPECT_THAT(read_firewall().dropping, IsEmpty());
    ASSERT_TRUE(add_chain("arrives", "input", "drop"));
    EXPECT_THAT(read_firewall().dropping, ElementsAre("inet filter arrives"));
  });
}

}  // namespace peerd::doctor::read_firewall_test
