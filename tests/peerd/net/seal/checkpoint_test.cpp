#include "peerd/net/seal/checkpoint.hpp"

#include <gtest/gtest.h>

#include <random>

namespace peerd::seal::checkpoint_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class Checkpoints : public testing::Test {
 protected:
  // The next datagram, which both sides note.
  void say() {
    sent.note(sent.count() + 1, tag());
    heard.note(numbered(sent.count(), bytes), now);
  }
  Tag tag() {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
  }
  std::size_t forged() { return heard.forged(sent.checkpoint(), sent.count(), now); }

  std::mt19937 random{7};
  std::array<std::uint8_t, kDatagramTag_bytes> bytes{};
  SentDatagrams sent;
  HeardDatagrams heard;
  HostTime now{seconds(10)};
};

TEST_F(Checkpoints, VouchForAllThatWasSentHoweverMuchItWas) {
  for (const int count : {0, 1, 15, 16, 17, 127, 128, 129, 1000, 5000}) {
    for (int i = 0; i < count; ++i) say();
    EXPECT_EQ(forged(), 0u) << count;
  }
}

// Few datagrams have long prints; of many, one in some has a short one: of those of two checkpoints, since each covers
// what the one before did.
TEST_F(Checkpoints, FindWhatWasNotSent) {
  for (const auto& [count, least] : {std::pair{1, 98}, {16, 90}, {100, 25}, {300, 5}}) {
    int found = 0;
    for (int round = 0; round < 100; ++round) {
      for (int i = 0; i < count; ++i) {
        say();
        if (i == count / 2) heard.note(numbered(sent.count(), tag()), now);
      }
      found += forged() > 0;
    }
    EXPECT_GE(found, least) << count;
  }
}

TEST_F(Checkpoints, FindWhatIsAheadOfAllThatWasSent) {
  say();
  heard.note(numbered(1'000'000, tag()), now);
  EXPECT_EQ(forged(), 0u) << "it may have overtaken others";
  now += HeardDatagrams::kAhead + milliseconds(1);
  EXPECT_EQ(forged(), 1u);
  EXPECT_EQ(forged(), 0u) << "once";
}

TEST_F(Checkpoints, CoverWhatTheLastOneCoveredTooForItMayBeLost) {
  say();
  heard.note(numbered(1, tag()), now);
  (void)sent.checkpoint();  // which nobody hears
  say();
  EXPECT_EQ(forged(), 1u);
}

TEST_F(Checkpoints, KnowWhatIsTheirOwn) {
  say();
  EXPECT_TRUE(sent.contains(numbered(1, bytes)));
  EXPECT_FALSE(sent.contains(numbered(2, bytes)));
  EXPECT_FALSE(sent.contains(numbered(1, tag())));
}

}  // namespace
}  // namespace peerd::seal::checkpoint_test
