#include "replication/loss_meter.hpp"

#include <gtest/gtest.h>

namespace peerd::replication {
namespace {

TEST(LossMeter, OneInTenBeforeAnythingIsKnown) { EXPECT_DOUBLE_EQ(LossMeter{}.loss(), 0.1); }

// lost: every k-th; 0: none.
double after(std::uint32_t datagrams, std::uint32_t every) {
  LossMeter meter;
  for (std::uint32_t i = 1; i <= datagrams; ++i) {
    if (every == 0 || i % every != 0) meter.on_datagram(i);
  }
  return meter.loss();
}

TEST(LossMeter, ComesToWhatIsLost) {
  EXPECT_LT(after(32, 0), kLossMin);
  EXPECT_NEAR(after(5000, 10), 0.1, 0.002);
  EXPECT_NEAR(after(5000, 2), 0.5, 0.006);
}

TEST(LossMeter, ForgetsABadMinute) {
  LossMeter meter;
  std::uint32_t i = 0;
  while (i < 1000) meter.on_datagram(i += 2);
  EXPECT_GT(meter.loss(), 0.45);
  while (i < 8000) meter.on_datagram(++i);
  EXPECT_LT(meter.loss(), 0.003);
}

TEST(LossMeter, LateIsNotLostAndDuplicatesAreNothing) {
  LossMeter in_order, shuffled;
  for (std::uint32_t i = 1; i <= 400; ++i) in_order.on_datagram(i);
  for (std::uint32_t i = 1; i <= 400; i += 4) {
    for (const std::uint32_t k : {i + 3, i, i, i + 2, i + 1, i + 3}) shuffled.on_datagram(k);
  }
  EXPECT_NEAR(shuffled.loss(), in_order.loss(), 1e-3);
}

TEST(LossMeter, AGapCountsForNoMoreThanTheWindow) {
  LossMeter meter;
  meter.on_datagram(1);
  meter.on_datagram(4'000'000'000U);  // a forger, or a night apart
  EXPECT_LT(meter.loss(), 0.95);
  for (std::uint32_t i = 1; i < 3000; ++i) meter.on_datagram(4'000'000'000U + i);
  EXPECT_LT(meter.loss(), 0.01);
}

TEST(LossMeter, CountsWhatIsMissingSinceTheFirst) {
  LossMeter meter;
  meter.on_datagram(10);
  meter.on_datagram(9);  // from before it listened
  EXPECT_EQ(meter.missing(), 0U);
  meter.on_datagram(14);
  EXPECT_EQ(meter.missing(), 3U);
  meter.on_datagram(12);
  meter.on_datagram(12);
  meter.on_datagram(8);
  EXPECT_EQ(meter.missing(), 3U) << "late ones don't take back what was said";
  meter.on_datagram(200);
  EXPECT_EQ(meter.missing(), 3U + 185U);
  EXPECT_EQ(meter.highest(), 200U);
}

TEST(LossMeter, CountsWhatCameTwiceAndWhatWasOvertaken) {
  LossMeter meter;
  for (const std::uint32_t number : {10U, 12U, 11U, 11U, 12U, 200U, 13U}) meter.on_datagram(number);
  EXPECT_EQ(meter.duplicates(), 2U);
  EXPECT_EQ(meter.overtaken(), 2U);
}

TEST(CopiesAgainst, FewestThatSuffice) {
  EXPECT_EQ(copies_against(0.0, 4), 1U);
  EXPECT_EQ(copies_against(0.0059, 4), 1U);
  EXPECT_EQ(copies_against(0.006, 4), 2U);
  EXPECT_EQ(copies_against(0.09, 4), 3U);
  EXPECT_EQ(copies_against(0.11, 4), 4U);
  EXPECT_EQ(copies_against(0.5, 4), 4U);
  EXPECT_EQ(copies_against(0.5, 1), 1U);
}

}  // namespace
}  // namespace peerd::replication
