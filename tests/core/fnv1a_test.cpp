#include "core/fnv1a.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace peerd::fnv1a_test {

constexpr std::uint64_t kOffsetBasis = 0xCBF29CE484222325;

// Fowler, Noll and Vo's test vector for the text "foobar" is 0x85944171F73967E8; the loop goes on from there.
TEST(Fnv1a, IsThatOfTheBytesOfTheNumberTheLowestFirst) {
  std::uint64_t by_bytes = kOffsetBasis, number = 0;
  int at = 0;
  for (const char c : std::string_view("foobar12")) {
    by_bytes = (by_bytes ^ static_cast<unsigned char>(c)) * 1099511628211U;
    number |= std::uint64_t{static_cast<unsigned char>(c)} << (8 * at++);
    if (at == 6) {
      EXPECT_EQ(by_bytes, 0x85944171F73967E8U);
    }
  }
  EXPECT_EQ(fnv1a(kOffsetBasis, number), by_bytes);
  EXPECT_NE(fnv1a(fnv1a(kOffsetBasis, 1), 2), fnv1a(fnv1a(kOffsetBasis, 2), 1));
}

}  // namespace peerd::fnv1a_test
