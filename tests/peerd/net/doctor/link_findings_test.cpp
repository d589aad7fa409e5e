#include <gtest/gtest.h>

#include "tests/peerd/net/doctor/made_up_facts.hpp"

namespace peerd::doctor::link_findings_test {

using testing_support::ethernet;
using testing_support::facts_with;
using testing_support::find;
using testing_support::multicast_over;
using testing_support::unicast;

TEST(LinkFindings, TheMtuHoldsALongestDatagram) {
  for (const auto& [mtu, ipv6, level] :
       {std::tuple(1260u, false, Level::kGood), std::tuple(1259u, false, Level::kWarning),
        std::tuple(1280u, true, Level::kGood), std::tuple(1279u, true, Level::kWarning)}) {
    Link link = ethernet("eth0", 2);
    link.mtu_bytes = mtu;
    Examined examined = multicast_over("eth0");
    examined.ipv6 = ipv6;
    EXPECT_EQ(find(host_findings(facts_with({link}), examined), "mtu").level, level) << mtu;
  }
}

TEST(LinkFindings, ABridgeThatForgetsGroupsIsNamed) {
  Link port = ethernet("eth0", 2), bridge = ethernet("br0", 3);
  bridge.kind = "bridge";
  bridge.snooping = true;
  const auto level = [&](const Examined& examined) {
    const auto findings = host_findings(facts_with({port, bridge}), examined);
    const auto found = std::ranges::find(findings, "snooping", &Finding::name);
    return found == findings.end() ? Level::kGood : found->level;
  };
  EXPECT_EQ(level(multicast_over("br0")), Level::kWarning);
  EXPECT_EQ(level(multicast_over("eth0")), Level::kHint) << "it is not on the way";
  EXPECT_EQ(level(unicast()), Level::kGood);
  port.bridge_index = 3;
  EXPECT_EQ(level(multicast_over("eth0")), Level::kWarning);
  bridge.querier_elsewhere = true;
  EXPECT_EQ(level(multicast_over("br0")), Level::kGood);
  bridge.querier_elsewhere = false, bridge.querier = true;
  EXPECT_EQ(level(multicast_over("br0")), Level::kGood);
  bridge.querier = false, bridge.snooping = false;
  EXPECT_EQ(level(multicast_over("br0")), Level::kGood);
}

TEST(LinkFindings, AWirelessInterfaceIsAHint) {
  Link link = ethernet("wlan0", 2);
  link.wireless = true;
  EXPECT_EQ(find(host_findings(facts_with({link}), multicast_over("wlan0")), "wireless").level, Level::kHint);
}

TEST(LinkFindings, AnInterfaceThatDropsOtherSubnetsIsNamed) {
  Link link = ethernet("eth0", 2);
  HostFacts facts = facts_with({link});
  const auto has = [&](const Examined& examined) {
    const auto findings = host_findings(facts, examined);
    return std::ranges::find(findings, "rp_filter", &Finding::name) != findings.end();
  };
  EXPECT_FALSE(has(multicast_over("eth0")));
  facts.links[1].strict_sources = true;
  EXPECT_EQ(find(host_findings(facts, multicast_over("eth0")), "rp_filter").level, Level::kHint);
  EXPECT_FALSE(has(unicast()));
  facts.dropped_by_source = 3;
  EXPECT_EQ(find(host_findings(facts, multicast_over("eth0")), "rp_filter").level, Level::kWarning);
  Examined ipv6 = multicast_over("eth0");
  ipv6.ipv6 = true;
  EXPECT_FALSE(has(ipv6));
}

}  // namespace peerd::doctor::link_findings_test
