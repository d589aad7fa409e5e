#include "peerd/net/seal/check_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <map>

namespace peerd::seal {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;

class Checks : public testing::Test {
 protected:
  bool comes(const char* from, std::uint32_t sender, std::byte what = {}) {
    const asio::ip::udp::endpoint at(asio::ip::make_address(from), 1);
    return queue.push({RegionId{0}, std::span(&what, 1), now, at}, PeerId{sender});
  }
  // How many of each address have their turn among the next ones.
  std::map<std::string, int> turns(int count) {
    std::map<std::string, int> all;
    for (int i = 0; i < count; ++i) {
      const auto next = queue.next(now);
      if (!next) break;
      ++all[next->from.address().to_string()];
    }
    return all;
  }
  CheckQueue queue;
  HostTime now{100s};
};

TEST_F(Checks, AreFreeUntilTheyAreTooMany) {
  int free = 0;
  for (; queue.is_free(now); ++free) queue.note_check(now);
  EXPECT_EQ(free, 64);
  now += 10ms;
  EXPECT_TRUE(queue.is_free(now));
  ASSERT_TRUE(comes("192.0.2.1", 1));
  EXPECT_FALSE(queue.is_free(now)) << "what waits comes first";
  ASSERT_TRUE(queue.next(now));
  EXPECT_TRUE(queue.is_free(now));
}

TEST_F(Checks, WaitForTheRate) {
  for (int i = 0; i < 64; ++i) queue.note_check(now);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(comes("192.0.2.1", 1));
  EXPECT_FALSE(queue.next(now));
  int made = 0;
  for (int i = 0; i < 4; ++i, now += 500us) {
    for (; queue.next(now); ++made) queue.note_check(now);
  }
  EXPECT_EQ(made, 6) << "4,000 a second in 1.5 ms";
}

TEST_F(Checks, AddressesAndTheirPeersTakeTurns) {
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(comes("192.0.2.1", 1));
    ASSERT_TRUE(comes("192.0.2.1", 2));
  }
  ASSERT_TRUE(comes("192.0.2.2", 3));
  ASSERT_TRUE(comes("192.0.2.1", 4));
  EXPECT_EQ(turns(2), (std::map<std::string, int>{{"192.0.2.1", 1}, {"192.0.2.2", 1}}));
  (void)turns(2);
  EXPECT_EQ(queue.size(), 118u) << "the third peer of the first address has had its turn";
}

TEST_F(Checks, WhoFloodsLosesItsOwn) {
  int lost = 0;
  for (int i = 0; i < 2000; ++i) lost += comes("192.0.2.1", 1) ? 0 : 1;
  EXPECT_EQ(lost, 2000 - 64);
  for (std::uint32_t peer = 2; peer < 102; ++peer) {
    for (int i = 0; i < 64; ++i) (void)comes("192.0.2.1", peer);
  }
  EXPECT_EQ(queue.size(), CheckQueue::kMost);
  for (int i = 0; i < 10; ++i) (void)comes("192.0.2.9", 200);
  EXPECT_EQ(queue.size(), CheckQueue::kMost);
  EXPECT_EQ(turns(20), (std::map<std::string, int>{{"192.0.2.1", 10}, {"192.0.2.9", 10}}));
}

TEST_F(Checks, DatagramsStayAsTheyCame) {
  ASSERT_TRUE(comes("192.0.2.1", 1, std::byte{7}));
  ASSERT_TRUE(comes("192.0.2.1", 1, std::byte{8}));
  const HostTime came = now;
  now += 1s;
  for (const int what : {7, 8}) {
    const auto next = queue.next(now);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->datagram, std::vector{static_cast<std::byte>(what)});
    EXPECT_EQ(next->at, came);
  }
  EXPECT_FALSE(queue.next(now));
}

}  // namespace
}  // namespace peerd::seal
