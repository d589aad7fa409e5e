#include "replication/session/echo_state.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::echo_state_test {

using namespace test;

constexpr PeerId kTwo{2};

Echo echo(const Received& received) { return {kTwo, received.highest, 0s, received, 0.0}; }

TEST(Acknowledgement, HasWhatCameSinceTheFirst) {
  Acknowledgement acknowledgement(Received{10, 10, ~std::uint64_t{0}});  // of what came before nothing is known
  EXPECT_FALSE(acknowledgement.has(10));
  acknowledgement.on_echo(echo({20, 2, ~std::uint64_t{0b100}}));  // all but 18
  acknowledgement.on_echo(echo({15, 15, ~std::uint64_t{0}}));     // overtaken
  for (std::uint32_t number = 1; number < 30; ++number) {
    EXPECT_EQ(acknowledgement.has(number), number > 10 && number <= 20 && number != 18) << number;
    EXPECT_EQ(acknowledgement.surely_lost(number), number == 18) << number;
  }
}

TEST(Acknowledgement, OldNumbersAreOnlyKnownToHaveArrived) {
  Acknowledgement acknowledgement(Received{10, 10, ~std::uint64_t{0}});
  acknowledgement.on_echo(echo({200, 1, ~std::uint64_t{0b10}}));
  EXPECT_TRUE(acknowledgement.has(137) && acknowledgement.surely_lost(199));
  EXPECT_FALSE(acknowledgement.has(136) || acknowledgement.surely_lost(136));
  acknowledgement.on_echo(echo({200, 100, ~std::uint64_t{0}}));  // 199 came late
  EXPECT_TRUE(acknowledgement.has(101));
  EXPECT_FALSE(acknowledgement.has(100) || acknowledgement.surely_lost(100));
}

TEST(EchoState, ReportsNoLossWhereNothingIsMissing) {
  EchoState state;
  EXPECT_EQ(state.reported_loss(), std::nullopt);
  const auto on_echo = [&](const Received& received) {
    Echo e = echo(received);
    e.loss = 0.002;  // an estimate never gets to zero
    (void)state.on_echo(e);
  };
  on_echo({10, 2, ~std::uint64_t{0b100}});
  on_echo({20, 12, ~std::uint64_t{0}});
  EXPECT_EQ(state.reported_loss(), 0.0) << "all that came after the first echo";
  on_echo({30, 3, ~std::uint64_t{0b1000}});
  EXPECT_EQ(state.reported_loss(), 0.002);
}

}  // namespace peerd::replication::echo_state_test
