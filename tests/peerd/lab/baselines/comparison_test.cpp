#include "peerd/lab/baselines/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/peerd/lab/baselines/systems.hpp"

namespace peerd::baselines::comparison_test {

using namespace baselines::testing_support;
using testing::HasSubstr;

TEST(ComparedSystems, SayHowLateAndHowWrongEachIs) {
  const auto of = [](const char* system) {
    return compared(system, run_system(sim::testing_support::kEq47, system, {"network.latency_ms=100"}), 1.0, {});
  };
  const Compared lockstep = of("lockstep"), server = of("server"), dead_reckoning = of("thesis");
  EXPECT_NEAR(lockstep.own_delay_ms.value(), 130, 30);
  EXPECT_EQ(lockstep.view_difference_m, 0.0);
  EXPECT_NEAR(server.own_delay_ms.value(), 0, 3);
  EXPECT_NEAR(server.others_delay_ms.value(), 320, 40);
  EXPECT_LT(dead_reckoning.others_delay_ms.value(), 60);
  EXPECT_LT(dead_reckoning.bytes_per_s, server.bytes_per_s);
}

TEST(ComparedSystems, StandInATableAPageAndJson) {
  Compared one{.system = "ours", .simulated_s = 10, .cpu_s = 0.5, .bytes_per_s = 1000, .shown_error_m = 0.1};
  Compared other = one;
  other.system = "<other>";
  other.key_to_own_ms = 17.0;
  const std::vector<Compared> systems{one, other};
  EXPECT_THAT(table(systems), HasSubstr("ours"));
  const std::string html = page("a & b", systems);
  EXPECT_THAT(html, HasSubstr("<h1>a &amp; b</h1>"));
  EXPECT_THAT(html, HasSubstr(R"({"system":"\u003cother>","simulated_s":10.0,)"));
  const auto json = to_json(systems);
  EXPECT_TRUE(json[0]["key_to_own_ms"].is_null());
  EXPECT_EQ(json[1]["key_to_own_ms"], 17.0);
}

}  // namespace peerd::baselines::comparison_test
