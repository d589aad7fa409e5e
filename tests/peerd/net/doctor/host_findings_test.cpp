#include "peerd/net/doctor/host_findings.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/net/doctor/made_up_facts.hpp"

namespace peerd::doctor::host_findings_test {

using testing_support::code;
using testing_support::ethernet;
using testing_support::facts_with;
using testing_support::multicast_over;
using testing_support::unicast;

TEST(HostFindings, AConnectedInterfaceIsGood) {
  const auto findings = host_findings(facts_with({ethernet("eth0", 2)}), multicast_over("eth0"));
  EXPECT_TRUE(std::ranges::all_of(findings, [](const Finding& f) { return f.level == Level::kGood; }))
      << as_text(findings);
}

TEST(HostFindings, WhoReachesNobodyIsNeverGood) {
  Link unplugged = ethernet("eth0", 2), down = ethernet("eth1", 3);
  unplugged.has_carrier = false;
  down.up = false;
  HostFacts facts = facts_with({unplugged, down});
  EXPECT_EQ(code(facts, multicast_over("lo")), 1);
  EXPECT_EQ(code(facts, multicast_over("eth0")), 1);
  EXPECT_EQ(code(facts, multicast_over("eth1")), 1);
  EXPECT_EQ(code(facts, multicast_over("gone")), 1);
  EXPECT_EQ(code(facts, unicast()), 1) << "nobody is listed, and nobody could greet it";
  EXPECT_EQ(code(facts, {.problem = "no interface"}), 3);
  Examined here = multicast_over("eth2");
  facts.links.push_back(ethernet("eth2", 4));
  EXPECT_EQ(code(facts, here), 0);
  here.ttl = 0;
  EXPECT_EQ(code(facts, here), 1);
}

}  // namespace peerd::doctor::host_findings_test
