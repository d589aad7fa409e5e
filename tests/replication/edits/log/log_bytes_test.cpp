// A LogBytes is one sequence of bytes, whatever of it is packed.
#include "replication/edits/log/log_bytes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace peerd::replication::log_bytes_test {

using Bytes = std::vector<std::byte>;

// Some of them repeat, as in logs.
Bytes random_bytes(std::mt19937_64& random, std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i % 8 == 0 ? random() : i % 24);
  return bytes;
}

TEST(LogBytes, AreWhatWasAppended) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    LogBytes log, other;
    LogBytes::Unpacked unpacked;
    Bytes expected, of_other;
    std::uint64_t final = 0;
    for (int k = 0; k < 60; ++k) {
      const Bytes more = random_bytes(random, random() % (2 * LogBytes::kBlock_bytes));
      log.append(more);
      expected.insert(expected.end(), more.begin(), more.end());
      if (random() % 4 == 0) {
        const std::uint64_t size = final + random() % (expected.size() - final + 1);
        log.cut(size);
        expected.resize(size);
      }
      EXPECT_TRUE(std::ranges::equal(log.rest(final), std::span(expected).subspan(final)));
      if (random() % 2 == 0) {
        final += random() % (expected.size() - final + 1);
        log.pack(final);
      }
      other.append(more);
      other.pack(other.size());
      of_other.insert(of_other.end(), more.begin(), more.end());
      ASSERT_EQ(log.size(), expected.size());
      EXPECT_EQ(log.empty(), expected.empty());
      for (int i = 0; i < 20; ++i) {
        const std::uint64_t from = random() % (expected.size() + 1),
                            to = from + random() % (expected.size() - from + 1);
        EXPECT_TRUE(std::ranges::equal(log.copy(from, to, unpacked), std::span(expected).subspan(from, to - from)));
        const std::uint64_t at = random() % of_other.size(), size = std::min<std::uint64_t>(40, of_other.size() - at);
        EXPECT_TRUE(std::ranges::equal(other.copy(at, at + size, unpacked), std::span(of_other).subspan(at, size)));
      }
    }
  }
}

}  // namespace peerd::replication::log_bytes_test
