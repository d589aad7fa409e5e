#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/net/doctor/made_up_facts.hpp"

namespace peerd::doctor::place_findings_test {

using testing::HasSubstr;
using testing_support::code;
using testing_support::ethernet;
using testing_support::facts_with;
using testing_support::find;
using testing_support::multicast_over;
using testing_support::unicast;

TEST(PlaceFindings, AContainerBehindItsHostReachesThatOnly) {
  Link end = ethernet("eth0", 2);
  end.other_end_elsewhere = true;
  HostFacts facts = facts_with({end});
  EXPECT_EQ(code(facts, multicast_over("eth0")), 0) << "a namespace is no container";
  facts.container = "docker";
  EXPECT_EQ(code(facts, multicast_over("eth0")), 1);
  Examined seen = multicast_over("eth0");
  seen.with_another = true;
  EXPECT_EQ(code(facts, seen), 0) << "what another computer has seen counts more";
  facts.routes = {{"a:1", Route::Way::kOutwards, "eth0"}};
  EXPECT_EQ(code(facts, unicast()), 0);
  EXPECT_THAT(find(host_findings(facts, unicast()), "container").advice, HasSubstr("-p 47474:47474/udp"));
  facts.container = "lxc";
  EXPECT_EQ(find(host_findings(facts, multicast_over("eth0")), "container").level, Level::kHint);
}

TEST(PlaceFindings, AFirewallThatWasNotReadIsAHintWithThePorts) {
  HostFacts facts = facts_with({ethernet("eth0", 2)});
  Examined examined = multicast_over("eth0");
  examined.discovery_port = 47473;
  const auto firewall = [&] { return find(host_findings(facts, examined), "firewall"); };
  EXPECT_EQ(firewall().level, Level::kGood);
  facts.firewall.older_tables = true;
  EXPECT_EQ(firewall().level, Level::kHint);
  facts.firewall.readable = false;
  EXPECT_EQ(firewall().advice,
            "let UDP 47474 and 47473 (peerd ls), and IGMP, in; for who joins TCP at a port that "
            "transport.snapshot_port sets");
  facts.firewall = {.readable = true, .dropping = {"inet filter input", "ip filter INPUT"}};
  examined.snapshot_port = 4000;
  EXPECT_THAT(firewall().sentence, HasSubstr("(inet filter input, ip filter INPUT)"));
  EXPECT_THAT(firewall().advice, HasSubstr("TCP 4000 for who joins"));
}

}  // namespace peerd::doctor::place_findings_test
