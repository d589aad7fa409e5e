#include "peerd/input/compression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd {
namespace {

using testing::HasSubstr;

TEST(Compression, GivesTheSameBytes) {
  for (const std::string& bytes : {std::string(), std::string("some bytes"), std::string(10'000'000, '\0')}) {
    const std::string frame = compress(bytes);
    EXPECT_TRUE(must(decompress(frame, bytes.size())) == bytes);
    if (bytes.empty()) continue;
    EXPECT_FALSE(decompress(frame, bytes.size() - 1));
  }
}

// 2^40 bytes, in a last block of none. A frame of this kind has ended a peer that read its store for want of memory.
TEST(Compression, AFrameThatSaysThatItIsLongerThanItCanBeGetsNoMemory) {
  const std::string frame("\x28\xb5\x2f\xfd\xe0\0\0\0\0\0\1\0\0\1\0\0", 16);
  EXPECT_THAT(error_of(decompress(frame, std::size_t{1} << 62)), HasSubstr("it says that it is longer"));
}

}  // namespace
}  // namespace peerd
