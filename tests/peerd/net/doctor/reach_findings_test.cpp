#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/net/doctor/made_up_facts.hpp"

namespace peerd::doctor::reach_findings_test {

using testing::HasSubstr;
using testing_support::code;
using testing_support::ethernet;
using testing_support::facts_with;
using testing_support::find;
using testing_support::unicast;

TEST(ReachFindings, TheRoutesToConfiguredPeersDecideOfUnicast) {
  struct Case {
    Route route;
    int exit_code;
    const char* says;
  };
  Link unplugged = ethernet("eth1", 3);
  unplugged.has_carrier = false;
  HostFacts facts = facts_with({ethernet("eth0", 2), unplugged});
  for (const auto& [route, exit_code, says] : {
           Case{{"a:1", Route::Way::kOutwards, "eth0"}, 0, "a route to a:1 over eth0"},
           Case{{"a:1", Route::Way::kOutwards, ""}, 0, "a route to a:1"},
           Case{{"a:1", Route::Way::kOutwards, "eth1"}, 1, "eth1, which is not connected"},
           Case{{"a:1", Route::Way::kNone}, 1, "no route to a:1"},
           Case{{"a:1", Route::Way::kThisComputer}, 1, "this computer itself"},
       }) {
    facts.routes = {route};
    EXPECT_EQ(code(facts, unicast()), exit_code) << says;
    EXPECT_THAT(find(host_findings(facts, unicast()), "reach").sentence, HasSubstr(says));
  }
}

}  // namespace peerd::doctor::reach_findings_test
