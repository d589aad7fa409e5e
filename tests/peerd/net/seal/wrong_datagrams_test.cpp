#include "peerd/net/seal/wrong_datagrams.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace peerd::seal::wrong_datagrams_test {

std::vector<std::byte> datagram(std::size_t number) {
  return {std::byte{1}, static_cast<std::byte>(number), static_cast<std::byte>(number >> 8)};
}

TEST(WrongDatagrams, AreKnownByAllTheirBytes) {
  WrongDatagrams wrong(net::random_key());
  EXPECT_FALSE(wrong.contains(datagram(1)));
  wrong.note(datagram(1));
  EXPECT_TRUE(wrong.contains(datagram(1)));
  EXPECT_FALSE(wrong.contains(datagram(2)));
  EXPECT_FALSE(wrong.contains({}));
}

TEST(WrongDatagrams, TheLastOnesTakeThePlacesOfOthers) {
  WrongDatagrams wrong(net::random_key());
  std::size_t known = 0;
  for (std::size_t i = 0; i < 20 * WrongDatagrams::kKept; ++i) wrong.note(datagram(i));
  for (std::size_t i = 0; i < 20 * WrongDatagrams::kKept; ++i) known += wrong.contains(datagram(i)) ? 1 : 0;
  EXPECT_LE(known, WrongDatagrams::kKept);
  EXPECT_TRUE(wrong.contains(datagram(20 * WrongDatagrams::kKept - 1)));
}

}  // namespace peerd::seal::wrong_datagrams_test
