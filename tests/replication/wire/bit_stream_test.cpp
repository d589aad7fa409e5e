#include "replication/wire/bit_stream.hpp"

#include <gtest/gtest.h>

#include <random>
#include <span>
#include <vector>

namespace peerd::replication::bit_stream_test {

struct Field {
  std::uint64_t value;
  int bits;
};

// Many short fields, and fields of any width that is allowed.
std::vector<Field> random_fields(std::mt19937_64& random) {
  std::vector<Field> fields(random() % 24);
  for (Field& f : fields) {
    f.bits = static_cast<int>(random() % (random() % 2 == 0 ? 9 : kFieldMax_bits + 1));
    f.value = random() & ((std::uint64_t{1} << f.bits) - 1);
  }
  return fields;
}

bool bit(std::span<const std::byte> bytes, std::size_t i) {
  return i / 8 < bytes.size() && (std::to_integer<unsigned>(bytes[i / 8]) >> i % 8 & 1) != 0;
}

TEST(BitStream, WritesBitByBitInOrder) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 5000; ++round) {
    SCOPED_TRACE(round);
    const std::vector<Field> fields = random_fields(random);
    std::size_t size_bits = 0;
    for (const Field& f : fields) size_bits += static_cast<std::size_t>(f.bits);
    std::vector<std::byte> bytes((size_bits + 7) / 8, std::byte{0xFF});  // just enough
    BitWriter out(bytes);
    for (const Field& f : fields) out.put(f.value, f.bits);
    ASSERT_EQ(out.finish(), bytes.size());
    std::size_t at = 0;
    for (const Field& f : fields) {
      for (int i = 0; i < f.bits; ++i) ASSERT_EQ(bit(bytes, at++), (f.value >> i & 1) != 0);
    }
    for (; at < 8 * bytes.size(); ++at) ASSERT_FALSE(bit(bytes, at));
  }
}

TEST(BitStream, ReadsBitByBitAndZerosBeyondTheEnd) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 5000; ++round) {
    SCOPED_TRACE(round);
    std::vector<std::byte> bytes(random() % 40);
    for (std::byte& b : bytes) b = random() % 3 == 0 ? std::byte{0} : static_cast<std::byte>(random() & 0xFF);
    BitReader in(bytes);
    std::size_t at = 0;
    for (const Field& f : random_fields(random)) {
      const std::uint64_t value = in.get(f.bits);
      for (int i = 0; i < f.bits; ++i) ASSERT_EQ((value >> i & 1) != 0, bit(bytes, at++));
      ASSERT_EQ(value >> f.bits, 0u);
      ASSERT_EQ(in.good(), at <= 8 * bytes.size());
      if (!in.good()) continue;
      ASSERT_EQ(in.size_bytes(), (at + 7) / 8);
      bool padded = true;
      for (std::size_t i = at; i % 8 != 0; ++i) padded = padded && !bit(bytes, i);
      ASSERT_EQ(in.padded_with_zeros(), padded);
    }
  }
}

}  // namespace peerd::replication::bit_stream_test
