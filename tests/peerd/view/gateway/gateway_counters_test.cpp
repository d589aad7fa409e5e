#include "peerd/view/gateway/gateway_counters.hpp"

#include <gtest/gtest.h>

namespace peerd::gateway::gateway_counters_test {

TEST(GatewayCounters, EachRefusalHasACounterOfItsName) {
  GatewayCounters counters;
  for (std::size_t i = 0; i < kRefusalKinds; ++i) counters.refused.at(i) = i + 1;
  const auto named = counters.named();
  for (std::size_t i = 0; i < kRefusalKinds; ++i) {
    const auto& text = text_of(static_cast<RefusalKind>(i));
    EXPECT_EQ(named.at("gateway.refused_" + std::string(text.name)), i + 1);
  }
  EXPECT_EQ(named.size(), kRefusalKinds + 8) << "no two have one name";
}

}  // namespace peerd::gateway::gateway_counters_test
