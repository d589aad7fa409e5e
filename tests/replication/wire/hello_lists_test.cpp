#include "replication/wire/hello_lists.hpp"

#include <gtest/gtest.h>

namespace peerd::replication::hello_lists_test {

std::vector<Echo> echoes_of(const std::vector<std::uint32_t>& peers) {
  std::vector<Echo> echoes;
  for (const std::uint32_t peer : peers) echoes.push_back({PeerId{peer}, 1, Duration{0}, {}, 0.0});
  return echoes;
}

TEST(LeavesOut, WhereThereIsRoomForMore) {
  EXPECT_TRUE(leaves_out({}, PeerId{3}));
  EXPECT_TRUE(leaves_out(echoes_of({5, 6}), PeerId{3}));
}

TEST(LeavesOut, WhatAFullListPassesOver) {
  const auto echoes = echoes_of({10, 11, 12, 13, 14, 15, 16, 18, 19, 20, 21, 22, 23, 24, 25});
  EXPECT_TRUE(leaves_out(echoes, PeerId{17}));
  EXPECT_FALSE(leaves_out(echoes, PeerId{9})) << "its turn may be another";
  EXPECT_FALSE(leaves_out(echoes, PeerId{26}));
}

TEST(LeavesOut, WhatAListPassesOverThatGoesRound) {
  const auto echoes = echoes_of({30, 31, 32, 33, 35, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  for (const std::uint32_t peer : {34u, 36u, 99u, 1u, 3u}) EXPECT_TRUE(leaves_out(echoes, PeerId{peer})) << peer;
  for (const std::uint32_t peer : {13u, 20u, 29u}) EXPECT_FALSE(leaves_out(echoes, PeerId{peer})) << peer;
}

}  // namespace peerd::replication::hello_lists_test
