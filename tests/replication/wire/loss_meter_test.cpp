#include "replication/wire/loss_meter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace peerd::replication::loss_meter_test {

TEST(LossMeter, AssumesOneInTenBeforeAnySample) { EXPECT_DOUBLE_EQ(LossMeter{}.loss(), 0.1); }

TEST(LossMeter, ReportsWhatItCounted) {
  LossMeter meter;
  EXPECT_EQ(meter.measured_loss(), std::nullopt);
  for (std::uint32_t i = 1; i <= 100; ++i) meter.on_datagram(i);
  EXPECT_EQ(meter.measured_loss(), 0.0);
  EXPECT_GT(meter.loss(), 0.0) << "which decides on copies";
}

// lost: every k-th; 0: none.
double after(std::uint32_t datagrams, std::uint32_t every) {
  LossMeter meter;
  for (std::uint32_t i = 1; i <= datagrams; ++i) {
    if (every == 0 || i % every != 0) meter.on_datagram(i);
  }
  return meter.loss();
}

TEST(LossMeter, ComesToWhatIsLost) {
  EXPECT_LT(after(8, 0), kLossMin);
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
  EXPECT_NEAR(meter.loss(), 63.0 / 65.0, 0.01) << "63 of the 64 up to the second";
  for (std::uint32_t i = 1; i < 3000; ++i) meter.on_datagram(4'000'000'000U + i);
  EXPECT_LT(meter.loss(), 0.01);
}

TEST(LossMeter, ReportsWhichNumbersArrived) {
  LossMeter meter;
  meter.on_datagram(10);
  EXPECT_EQ(meter.received(), (Received{10, 10, ~std::uint64_t{0}})) << "what went before is not asked for";
  meter.on_datagram(14);
  EXPECT_EQ(meter.received(), (Received{14, 1, ~std::uint64_t{0b1110}}));
  meter.on_datagram(12);
  EXPECT_EQ(meter.received(), (Received{14, 1, ~std::uint64_t{0b1010}}));
  meter.on_datagram(13);
  meter.on_datagram(11);
  EXPECT_EQ(meter.received(), (Received{14, 14, ~std::uint64_t{0}}));
}

TEST(LossMeter, MarksUnusableDatagramsAsMissing) {
  LossMeter meter;
  for (std::uint32_t number = 1; number <= 3; ++number) meter.on_datagram(number);
  const double loss = meter.loss();
  meter.mark_as_missing(3);
  EXPECT_EQ(meter.received(), (Received{3, 0, ~std::uint64_t{1}}));
  meter.on_datagram(4);
  EXPECT_EQ(meter.received(), (Received{4, 1, ~std::uint64_t{0b10}}));
  EXPECT_LE(meter.loss(), loss) << "it was not lost";
  meter.on_datagram(3);
  EXPECT_EQ(meter.received(), (Received{4, 4, ~std::uint64_t{0}})) << "there it is";
  EXPECT_EQ(meter.duplicates(), 1u);
  meter.mark_as_missing(3);
  for (std::uint32_t number = 5; number <= 100; ++number) meter.on_datagram(number);
  EXPECT_EQ(meter.received().run, 97U);
  for (const std::uint32_t number : {0U, 3U, 101U}) meter.mark_as_missing(number);
  EXPECT_EQ(meter.received().run, 97U) << "no number, too old, or never come";
}

// The oracle is a list of all received numbers: every number that the meter acknowledges has come, and every one that
// it reports lost has not.
TEST(LossMeter, NeverReportsAWrongArrival) {
  std::mt19937_64 rng(1);
  for (int run = 0; run < 200; ++run) {
    LossMeter meter;
    std::set<std::uint32_t> came;
    std::uint32_t sent = 1, first = 0;
    for (int i = 0; i < 300; ++i) {
      const std::uint32_t gap = rng() % 40 == 0 ? 1 + rng() % 130 : 1;
      const std::uint32_t number =
          rng() % 5 == 0 && sent > 1 ? sent - std::min<std::uint32_t>(sent - 1, rng() % 90) : (sent += gap);
      if (rng() % 10 == 0 && i > 0) continue;
      meter.on_datagram(number);
      came.insert(number);
      first = first == 0 ? number : first;
      const Received r = meter.received();
      ASSERT_EQ(r.highest, *came.rbegin());
      for (std::uint32_t k = first; k <= sent + 1; ++k) {
        ASSERT_FALSE(r.has(k) && !came.contains(k)) << k;
        ASSERT_FALSE(r.surely_lost(k) && came.contains(k)) << k;
        const bool recent = k <= r.highest && r.highest - k < Received::kWindow;
        ASSERT_EQ(r.has(k) || r.surely_lost(k), recent || r.has(k)) << k;
      }
    }
  }
}

// A run is as long as the received numbers have no hole, up to the greatest length that is sent.
TEST(LossMeter, RemembersWhereItsLastHoleWas) {
  LossMeter meter;
  for (const std::uint32_t number : {1U, 2U, 4U}) meter.on_datagram(number);
  for (std::uint32_t number = 5; number <= 500; ++number) meter.on_datagram(number);
  EXPECT_EQ(meter.received().run, 497U);
  for (std::uint32_t number = 501; number <= 20'000; ++number) meter.on_datagram(number);
  EXPECT_EQ(meter.received().run, Received::kRunMax);
  meter.on_datagram(20'100);
  for (std::uint32_t number = 20'101; number <= 20'300; ++number) meter.on_datagram(number);
  EXPECT_EQ(meter.received().run, 201U);
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

}  // namespace peerd::replication::loss_meter_test
