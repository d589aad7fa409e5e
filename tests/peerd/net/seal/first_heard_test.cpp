#include "peerd/net/seal/first_heard.hpp"

#include <gtest/gtest.h>

namespace peerd::seal {
namespace {

using std::chrono::milliseconds;

BootId boot(std::size_t number) {
  BootId id{};
  for (std::size_t i = 0; i < sizeof(number); ++i) id.at(i) = static_cast<std::uint8_t>(number >> (8 * i));
  return id;
}

TEST(FirstHeard, ABootIsOldSomeTimeAfterItCameFirst) {
  FirstHeard heard;
  const HostTime begin{std::chrono::seconds(100)};
  EXPECT_FALSE(heard.is_old(boot(1), begin)) << "it has never come";
  heard.note(boot(1), begin);
  heard.note(boot(1), begin + FirstHeard::kNew);
  EXPECT_FALSE(heard.is_old(boot(1), begin + FirstHeard::kNew));
  EXPECT_TRUE(heard.is_old(boot(1), begin + FirstHeard::kNew + milliseconds(1)));
  EXPECT_FALSE(heard.is_old(boot(2), begin + FirstHeard::kNew + milliseconds(1)));
}

TEST(FirstHeard, IsBounded) {
  FirstHeard heard;
  const HostTime begin{std::chrono::seconds(100)}, later = begin + 2 * FirstHeard::kNew;
  for (std::size_t i = 0; i < FirstHeard::kMost; ++i) heard.note(boot(i), begin);
  heard.note(boot(0), later);
  EXPECT_TRUE(heard.is_old(boot(0), later)) << "who is known takes no room";
  heard.note(boot(FirstHeard::kMost), later);
  EXPECT_FALSE(heard.is_old(boot(0), later)) << "all begin anew";
}

}  // namespace
}  // namespace peerd::seal
