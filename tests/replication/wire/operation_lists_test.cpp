#include "replication/wire/operation_lists.hpp"

#include <gtest/gtest.h>

#include <random>

#include "replication/wire/codec.hpp"

namespace peerd::replication::operation_lists_test {

Message blank() {
  Message m;
  m.sender = PeerId{0xFFFF'FFFF};
  m.incarnation = incarnation_low(~std::uint64_t{0});
  m.number = 0xFFFF'FFFF;
  return m;
}
OperationPart part(std::uint32_t author, std::uint64_t from, std::size_t size) {
  return {AuthorId{author}, from, std::vector<std::byte>(size, std::byte{0xA5})};
}
bool same(const OperationPart& a, const OperationPart& b) {
  return a.author == b.author && a.from == b.from && a.bytes == b.bytes;
}

TEST(OperationLists, RoundTripInADatagram) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 500; ++i) {
    Message m = blank();
    m.hello.emplace();
    std::uint32_t author = 0;
    for (auto n = random() % 10; n > 0; --n) {
      author += 1 + static_cast<std::uint32_t>(random() % 100'000'000);
      m.hello->logs.push_back({AuthorId{author}, 1 + random() % kLogMax_bytes});
    }
    for (auto n = random() % 5; n > 0; --n) {
      m.operations.push_back(
          part(1 + static_cast<std::uint32_t>(random() % kAuthorMax), random() >> 30, 1 + random() % 150));
    }
    for (auto n = random() % 5; n > 0; --n) {
      const std::uint64_t from = random() >> 30;
      m.operation_requests.push_back({AuthorId{kAuthorMax}, from, from + 1 + random() % 100'000});
    }
    const auto back = decode(encode(m), SimTime{});
    ASSERT_TRUE(back.has_value()) << to_string(back.error());
    EXPECT_EQ(back->hello->logs, m.hello->logs);
    EXPECT_TRUE(std::ranges::equal(back->operations, m.operations, same));
    EXPECT_EQ(back->operation_requests, m.operation_requests);
    EXPECT_EQ(encode(*back), encode(m));
  }
}

TEST(OperationLists, NothingCostsNothing) {
  Message m = blank();
  EXPECT_EQ(encode(m).size(), 18u);  // version, sender, number, boot, as ever
  m.hello.emplace();
  EXPECT_EQ(encode(m).size(), 20u);
}

// A sender fills datagrams by the sizes that the lists really take.
TEST(OperationLists, TakeWhatTheySay) {
  for (const std::size_t size : {1, 100, 127, 128, 1000}) {
    Message m = blank();
    m.operations.push_back(part(kAuthorMax, kLogMax_bytes - 2000, size));
    const OperationRange range{AuthorId{kAuthorMax}, kLogMax_bytes - 2000, kLogMax_bytes - 2000 + size};
    const std::size_t list = part_header_bytes(range) + size, length_bytes = list < 128 ? 1 : 2;
    EXPECT_EQ(encode(m).size() - encode(blank()).size(), kOperationListHeader_bytes - 2 + length_bytes + list);
    m = blank();
    m.operation_requests.push_back(range);
    EXPECT_EQ(encode(m).size() - encode(blank()).size(), kOperationListHeader_bytes - 1 + encoded_size_bytes(range));
  }
  Message m = blank();
  m.hello.emplace();
  const std::size_t empty = encode(m).size();
  m.hello->logs = {{AuthorId{3}, 5}, {AuthorId{kAuthorMax}, kLogMax_bytes}};
  EXPECT_EQ(encode(m).size() - empty, kOperationListHeader_bytes - 1 + encoded_size_bytes(kNoAuthor, m.hello->logs[0]) +
                                          encoded_size_bytes(AuthorId{3}, m.hello->logs[1]));
  m = blank();
  m.operations.push_back(part(kAuthorMax, kLogMax_bytes - 2000, 1));
  const OperationRange range{AuthorId{kAuthorMax}, kLogMax_bytes - 2000, kLogMax_bytes - 1000};
  m.operations[0].bytes.resize(kOperationsMax_bytes - part_header_bytes(range));
  EXPECT_LE(encode(m).size(), kDatagramMax_bytes);
}

std::string bytes_of(std::initializer_list<int> numbers) {
  std::string bytes;
  for (const int n : numbers) bytes.push_back(static_cast<char>(n));
  return bytes;
}
bool logs_are_good(std::initializer_list<int> numbers) {
  std::vector<LogLength> logs;
  return take_logs(bytes_of(numbers), logs);
}
bool parts_are_good(std::initializer_list<int> numbers) {
  std::vector<OperationPart> parts;
  return take_parts(bytes_of(numbers), parts);
}
bool ranges_are_good(std::initializer_list<int> numbers) {
  std::vector<OperationRange> ranges;
  return take_ranges(bytes_of(numbers), ranges);
}

TEST(OperationLists, RefuseWhatNobodySends) {
  EXPECT_TRUE(logs_are_good({1, 1, 1, 1}));
  EXPECT_FALSE(logs_are_good({1}));                                      // cut short
  EXPECT_FALSE(logs_are_good({0, 1}));                                   // nobody
  EXPECT_FALSE(logs_are_good({1, 1, 0, 1}));                             // the same author twice
  EXPECT_FALSE(logs_are_good({1, 0}));                                   // an empty log
  EXPECT_TRUE(logs_are_good({0xFF, 0xFF, 0xFF, 0xFF, 0x07, 1}));         // 2^31 - 1
  EXPECT_FALSE(logs_are_good({0x80, 0x80, 0x80, 0x80, 0x08, 1}));        // 2^31
  EXPECT_FALSE(logs_are_good({0xFF, 0xFF, 0xFF, 0xFF, 0x07, 1, 1, 1}));  // behind it
  EXPECT_FALSE(logs_are_good({1, 0x81, 0x80, 0x80, 0x80, 0x80, 0x20}));  // 2^40 + 1 bytes
  EXPECT_TRUE(parts_are_good({1, 0, 2, 9, 9, 1, 5, 1, 9}));
  EXPECT_FALSE(parts_are_good({1, 0, 2, 9}));                                      // cut short
  EXPECT_FALSE(parts_are_good({1, 0, 0}));                                         // empty
  EXPECT_FALSE(parts_are_good({0, 0, 1, 9}));                                      // nobody
  EXPECT_FALSE(parts_are_good({1, 0x80, 0x80, 0x80, 0x80, 0x80, 0x20, 1, 9}));     // behind 2^40
  EXPECT_TRUE(parts_are_good({1, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x1F, 1, 9}));      // the last byte of the longest log
  EXPECT_FALSE(parts_are_good({1, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x1F, 2, 9, 9}));  // and one behind it
  EXPECT_TRUE(ranges_are_good({1, 0, 1}));
  EXPECT_FALSE(ranges_are_good({1, 0, 0}));
  EXPECT_FALSE(ranges_are_good({1, 0}));
  EXPECT_FALSE(ranges_are_good({0, 0, 1}));
  EXPECT_FALSE(ranges_are_good({1, 0x80, 0x00, 1}));  // not the shortest form
}

TEST(OperationLists, HaveLimitedEntries) {
  std::string logs, parts, ranges;
  for (std::size_t i = 0; i <= kLogLengthsMax; ++i) {
    std::vector<LogLength> taken;
    EXPECT_TRUE(take_logs(logs, taken));
    logs += bytes_of({1, 1});
  }
  for (std::size_t i = 0; i <= kOperationPartsMax; ++i) {
    std::vector<OperationPart> taken;
    EXPECT_TRUE(take_parts(parts, taken));
    parts += bytes_of({1, 0, 1, 9});
  }
  for (std::size_t i = 0; i <= kOperationRangesMax; ++i) {
    std::vector<OperationRange> taken;
    EXPECT_TRUE(take_ranges(ranges, taken));
    ranges += bytes_of({1, 0, 1});
  }
  std::vector<LogLength> taken_logs;
  std::vector<OperationPart> taken_parts;
  std::vector<OperationRange> taken_ranges;
  EXPECT_FALSE(take_logs(logs, taken_logs));
  EXPECT_FALSE(take_parts(parts, taken_parts));
  EXPECT_FALSE(take_ranges(ranges, taken_ranges));
}

}  // namespace peerd::replication::operation_lists_test
