#include "peerd/net/seal/wrong_datagrams.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace peerd::seal::wrong_datagrams_test {

constexpr HostTime kNow{std::chrono::hours(1)};

std::vector<std::byte> datagram(std::size_t number) {
  return {std::byte{1}, static_cast<std::byte>(number), static_cast<std::byte>(number >> 8)};
}

TEST(WrongDatagrams, AreKnownByAllTheirBytes) {
  WrongDatagrams wrong(net::random_key());
  EXPECT_FALSE(wrong.contains(datagram(1), kNow));
  wrong.note(datagram(1), kNow);
  EXPECT_TRUE(wrong.contains(datagram(1), kNow));
  EXPECT_FALSE(wrong.contains(datagram(2), kNow));
  EXPECT_FALSE(wrong.contains({}, kNow));
}

TEST(WrongDatagrams, TheLastOnesTakeThePlacesOfOthers) {
  constexpr std::size_t kNoted = 20 * WrongDatagrams::kKept;
  WrongDatagrams wrong(net::random_key());
  std::size_t known = 0, of_last = 0;
  for (std::size_t i = 0; i < kNoted; ++i) wrong.note(datagram(i), kNow);
  for (std::size_t i = 0; i < kNoted; ++i) {
    const bool is_known = wrong.contains(datagram(i), kNow);
    known += is_known ? 1 : 0;
    of_last += is_known && i >= kNoted - WrongDatagrams::kKept ? 1 : 0;
  }
  EXPECT_LE(known, WrongDatagrams::kKept);
  // Each of n places is free of later ones with (1 - 1/n)^k after k more, on average 1 - 1/e of them.
  EXPECT_GE(of_last, WrongDatagrams::kKept * 55 / 100);
  EXPECT_TRUE(wrong.contains(datagram(kNoted - 1), kNow));
}

TEST(WrongDatagrams, AllAreForgottenAMinuteAfterTheLastOne) {
  WrongDatagrams wrong(net::random_key());
  EXPECT_FALSE(wrong.are_there(kNow));
  wrong.note(datagram(1), kNow);
  const HostTime later = kNow + WrongDatagrams::kKeptFor;
  EXPECT_TRUE(wrong.contains(datagram(1), later));
  wrong.note(datagram(2), later);
  EXPECT_TRUE(wrong.contains(datagram(1), later + WrongDatagrams::kKeptFor));
  const HostTime over = later + WrongDatagrams::kKeptFor + Duration{1};
  EXPECT_FALSE(wrong.are_there(over));
  EXPECT_FALSE(wrong.contains(datagram(2), over));
  wrong.note(datagram(3), over);
  EXPECT_FALSE(wrong.contains(datagram(1), over)) << "it stays forgotten";
}

}  // namespace peerd::seal::wrong_datagrams_test
