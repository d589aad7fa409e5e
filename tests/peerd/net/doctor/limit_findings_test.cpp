#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/net/doctor/made_up_facts.hpp"

namespace peerd::doctor::limit_findings_test {

using testing::HasSubstr;
using testing_support::code;
using testing_support::ethernet;
using testing_support::facts_with;
using testing_support::find;
using testing_support::multicast_over;

TEST(LimitFindings, LimitsAndTheClockAreHints) {
  HostFacts facts = facts_with({ethernet("eth0", 2)});
  facts.clock_error.reset();
  facts.memberships_max = 4;
  facts.optmem_bytes = 1000;
  Examined examined = multicast_over("eth0");
  EXPECT_EQ(code(facts, examined), 0);
  EXPECT_EQ(find(host_findings(facts, examined), "clock").level, Level::kHint);
  EXPECT_THAT(find(host_findings(facts, examined), "memberships").advice, HasSubstr("igmp_max_memberships=20"));
  examined.ipv6 = true;
  EXPECT_THAT(find(host_findings(facts, examined), "memberships").advice, HasSubstr("optmem_max"));
}

TEST(LimitFindings, PortsOfOtherProgramsAreNamed) {
  HostFacts facts = facts_with({ethernet("eth0", 2)});
  facts.taken.snapshot = 4000;
  EXPECT_THAT(find(host_findings(facts, multicast_over("eth0")), "port").sentence, HasSubstr("TCP port 4000"));
  EXPECT_EQ(code(facts, multicast_over("eth0")), 0) << "it may be a peer that runs";
  facts.taken.discovery = 47473;
  EXPECT_THAT(find(host_findings(facts, multicast_over("eth0")), "port").sentence, HasSubstr("UDP port 47473"));
  EXPECT_EQ(code(facts, multicast_over("eth0")), 1);
}

}  // namespace peerd::doctor::limit_findings_test
