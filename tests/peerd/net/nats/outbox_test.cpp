#include "peerd/net/nats/outbox.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "tests/net/listener.hpp"

namespace peerd::nats::outbox_test {

using net::testing_support::bytes_of;
using net::testing_support::text_of;

constexpr Duration kNoTime{0};

TEST(Outbox, HandsOverInOrder) {
  Outbox outbox;
  EXPECT_TRUE(outbox.put(RegionId{1}, HostTime{Duration{5}}, bytes_of("one")));
  outbox.change({RegionId{7}, true});
  EXPECT_TRUE(outbox.put(RegionId{2}, HostTime{Duration{6}}, bytes_of("two")));
  Outbox::Taken taken = Outbox::make_taken();
  outbox.take(taken, kNoTime);
  ASSERT_EQ(taken.all().size(), 2u);
  EXPECT_EQ(text_of(taken.all()[0].datagram()), "one");
  EXPECT_EQ(taken.all()[0].at, HostTime{Duration{5}});
  EXPECT_EQ(taken.all()[1].region, RegionId{2});
  ASSERT_EQ(taken.changes.size(), 1u);
  EXPECT_TRUE(taken.changes[0].joins);
  EXPECT_FALSE(taken.stop);
  outbox.take(taken, kNoTime);
  EXPECT_TRUE(taken.all().empty());
  EXPECT_TRUE(taken.changes.empty());
}

// A worker that waits for the network keeps nobody, and changes of regions are not lost with datagrams.
TEST(Outbox, IsFullAtItsLimit) {
  Outbox outbox;
  for (std::size_t i = 0; i < Outbox::kParcelsMax; ++i) {
    ASSERT_TRUE(outbox.put(RegionId{0}, HostTime{}, bytes_of(std::to_string(i))));
  }
  EXPECT_FALSE(outbox.put(RegionId{0}, HostTime{}, bytes_of("too many")));
  outbox.change({RegionId{7}, false});
  Outbox::Taken taken = Outbox::make_taken();
  outbox.take(taken, kNoTime);
  EXPECT_EQ(taken.parcels, Outbox::kParcelsMax);
  EXPECT_EQ(text_of(taken.all().back().datagram()), std::to_string(Outbox::kParcelsMax - 1));
  EXPECT_EQ(taken.changes.size(), 1u);
  EXPECT_TRUE(outbox.put(RegionId{0}, HostTime{}, bytes_of("again")));
}

TEST(Outbox, StopEndsTheWait) {
  Outbox outbox;
  std::thread other([&] { outbox.stop(); });
  Outbox::Taken taken = Outbox::make_taken();
  outbox.take(taken, std::chrono::hours(1));
  EXPECT_TRUE(taken.stop);
  other.join();
}

}  // namespace peerd::nats::outbox_test
