#include "peerd/net/nats/connection_state.hpp"

#include <gtest/gtest.h>

namespace peerd::nats::connection_state_test {

std::string taken(ConnectionState& state) {
  const auto change = state.take_change();
  return change ? (change->is_back ? "+" : "-") + change->sentence : "nothing";
}

TEST(ConnectionState, SaysEachChangeOnce) {
  ConnectionState state;
  state.on_up("first");
  EXPECT_TRUE(state.is_up());
  EXPECT_EQ(taken(state), "nothing") << "describe() says the first";
  state.on_down("gone");
  state.on_down("gone");
  state.on_down("refused");
  EXPECT_FALSE(state.is_up());
  EXPECT_FALSE(state.is_closed());
  state.on_up("back");
  EXPECT_EQ(taken(state), "-gone");
  EXPECT_EQ(taken(state), "-refused") << "another reason";
  EXPECT_EQ(taken(state), "+back");
  EXPECT_EQ(taken(state), "nothing");
}

TEST(ConnectionState, OfAClosedConnectionBeginsAnew) {
  ConnectionState state;
  state.on_up("first");
  state.on_closed("refused");
  EXPECT_TRUE(state.is_closed());
  state.begin();
  EXPECT_FALSE(state.is_closed());
  state.on_down("refused");
  state.on_up("back");
  EXPECT_EQ(taken(state), "-refused");
  EXPECT_EQ(taken(state), "+back");
  state.on_closed("");
  EXPECT_EQ(taken(state), "nothing") << "it was closed on purpose";
}

TEST(ConnectionState, KeepsFewSentences) {
  ConnectionState state;
  for (int i = 0; i < 100; ++i) state.warn(std::to_string(i));
  int kept = 0;
  while (state.take_change()) ++kept;
  EXPECT_EQ(kept, 16);
}

}  // namespace peerd::nats::connection_state_test
