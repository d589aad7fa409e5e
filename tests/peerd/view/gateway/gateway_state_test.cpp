#include "peerd/view/gateway/gateway_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace peerd::gateway::gateway_state_test {

using namespace std::chrono_literals;
using Standing = Connection::Standing;

constexpr Connection::Clock::time_point kNow{1h};

class FakeConnection : public Connection {
 public:
  FakeConnection(Standing standing, Clock::duration active_ago, std::uint64_t n) : standing_(standing) {
    active_at = kNow - active_ago;
    number = n;
  }
  void close() override {}
  [[nodiscard]] Standing standing() const override { return standing_; }

 private:
  Standing standing_;
};

std::optional<RoomOrder> order_of(Standing standing, Connection::Clock::duration active_ago, std::uint64_t number = 1) {
  return room_order(FakeConnection(standing, active_ago, number), kNow);
}

TEST(RoomOrder, IsOfTheSilentThenOfStrangersThenOfWhoHasJustCome) {
  const std::vector in_order{
      order_of(Standing::kSilent, 5s),     order_of(Standing::kSilent, 1001ms),  order_of(Standing::kStranger, 1h),
      order_of(Standing::kStranger, 10s),  order_of(Standing::kStranger, 0s, 1), order_of(Standing::kStranger, 0s, 2),
      order_of(Standing::kSilent, 1000ms), order_of(Standing::kSilent, 500us),   order_of(Standing::kSilent, 0s)};
  for (std::size_t i = 0; i < in_order.size(); ++i) ASSERT_TRUE(in_order[i]) << i;
  for (std::size_t i = 1; i < in_order.size(); ++i) EXPECT_LT(*in_order[i - 1], *in_order[i]) << i;
}

TEST(RoomOrder, AnOwnerStays) { EXPECT_FALSE(order_of(Standing::kOwner, 1h)); }

}  // namespace peerd::gateway::gateway_state_test
