#include "peerd/net/greeting/source_buckets.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::net {
namespace {

using boost::asio::ip::address;
using boost::asio::ip::address_v4;
using boost::asio::ip::make_address;
using Kind = SourceBuckets::Kind;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SipKey kKey{1, 2};
constexpr SourceBuckets::Limits kLimits{.of_address = {10.0, 5.0}, .of_all = {100.0, 20.0}, .known = seconds(10)};
const address kA = make_address("192.0.2.1"), kB = make_address("2001:db8::1");
constexpr HostTime kBegin{seconds(1'000)};

// How many of so many at one instant are admitted.
int admitted(SourceBuckets& buckets, const address& from, Kind kind, HostTime now, int count = 1'000) {
  int passed = 0;
  for (int i = 0; i < count; ++i) passed += int(buckets.admits(from, kind, now));
  return passed;
}

TEST(SourceBuckets, AStrangerHasABucketForEachKind) {
  SourceBuckets buckets(kKey, kLimits);
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin), 10);
  EXPECT_EQ(admitted(buckets, kA, Kind::kAnnouncement, kBegin), 10) << "a flood of one kind leaves the other";
  EXPECT_EQ(admitted(buckets, kB, Kind::kDatagram, kBegin), 10) << "as does that of another address";
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin + seconds(1)), 5);
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin + seconds(100)), 10) << "it does not get fuller";
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin), 0) << "nor by a clock that goes back";
}

TEST(SourceBuckets, WhoIsKnownPaysNothing) {
  SourceBuckets buckets(kKey, kLimits);
  buckets.has_proven(kA, kBegin);
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin + milliseconds(9'999)), 1'000);
  EXPECT_EQ(admitted(buckets, kA, Kind::kDatagram, kBegin + seconds(10)), 10) << "for a while";
}

// All addresses of IPv4 that a sender can forge.
TEST(SourceBuckets, ManyStrangersShareOneMoreAndTakeNobodysPlace) {
  SourceBuckets buckets(kKey, kLimits);
  std::vector<address> known;
  for (std::uint32_t i = 0; i < 64; ++i) known.emplace_back(address_v4(0x0A000001 + i));
  for (const address& each : known) buckets.has_proven(each, kBegin);
  std::mt19937 random(7);
  HostTime now = kBegin;
  int passed = 0;
  for (int i = 0; i < 90'000; ++i, now += std::chrono::microseconds(100)) {
    passed += int(buckets.admits(address_v4(static_cast<std::uint32_t>(random()) | 0x40000000), Kind::kDatagram, now));
  }
  EXPECT_LE(passed, 100 + 9 * 20 + 1);
  EXPECT_GE(passed, 100 + 9 * 20 - 1);
  for (const address& each : known) EXPECT_EQ(admitted(buckets, each, Kind::kDatagram, now), 1'000) << each;
}

}  // namespace
}  // namespace peerd::net
