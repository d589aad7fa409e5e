#include "peerd/lab/recorded/mcap_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/input/compression.hpp"
#include "tests/must.hpp"

namespace peerd::mcap_writer_test {

using testing::ElementsAre;

std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << 8 * i;
  }
  return value;
}

struct Record {
  int opcode;
  std::string_view content;
};

std::vector<Record> records(std::string_view bytes) {
  std::vector<Record> all;
  while (!bytes.empty()) {
    const std::size_t length = number(bytes, 1, 8);
    all.push_back({static_cast<unsigned char>(bytes[0]), bytes.substr(9, length)});
    bytes.remove_prefix(9 + length);
  }
  return all;
}

std::vector<int> opcodes(const std::vector<Record>& all) {
  std::vector<int> codes;
  for (const Record& record : all) codes.push_back(record.opcode);
  return codes;
}

// The file as the specification has it; tests/browser/mcap_test.mjs reads one by another implementation.
TEST(McapWriter, WritesAFileOfWholeRecords) {
  std::ostringstream out;
  McapWriter writer(out);
  const auto schema = writer.add_schema("s", "jsonschema", "{}");
  const auto channel = writer.add_channel(schema, "/t", "json");
  writer.add_message(channel, 5, "first");
  writer.add_message(channel, 7, "second");
  writer.finish();
  const std::string file = out.str();
  EXPECT_EQ(file.size(), writer.size_bytes());
  EXPECT_EQ(writer.messages(), 2u);
  constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
  ASSERT_TRUE(file.starts_with(kMagic));
  ASSERT_TRUE(file.ends_with(kMagic));
  const auto all = records(std::string_view(file).substr(8, file.size() - 16));
  ASSERT_THAT(opcodes(all), ElementsAre(1, 6, 7, 15, 3, 4, 11, 8, 14, 14, 14, 14, 2));
  // A chunk: two times, the size unpacked, a checksum, "zstd", the size packed.
  const std::string_view chunk = all[1].content;
  EXPECT_EQ(number(chunk, 0, 8), 5u);
  EXPECT_EQ(number(chunk, 8, 8), 7u);
  const auto unpacked = must(decompress(chunk.substr(8 + 8 + 8 + 4 + 8 + 8), 1 << 20));
  EXPECT_EQ(unpacked.size(), number(chunk, 16, 8));
  const auto inner = records(unpacked);
  ASSERT_THAT(opcodes(inner), ElementsAre(3, 4, 5, 5));
  EXPECT_EQ(inner[2].content.substr(22), "first");
  // The footer says where the summary is, and where its offsets are.
  const std::size_t summary_at = number(all.back().content, 0, 8), offsets_at = number(all.back().content, 8, 8);
  EXPECT_EQ(file.at(summary_at), 3);
  EXPECT_EQ(file.at(offsets_at), 14);
}

TEST(McapWriter, BeginsAnotherChunkForEachMebibyte) {
  std::ostringstream out;
  McapWriter writer(out);
  const auto channel = writer.add_channel(writer.add_schema("s", "jsonschema", "{}"), "/t", "json");
  const std::string text(100'000, 'x');
  for (int i = 0; i < 50; ++i) writer.add_message(channel, static_cast<std::uint64_t>(i), text);
  writer.finish();
  const std::string file = out.str();
  std::size_t chunks = 0;
  for (const Record& record : records(std::string_view(file).substr(8, file.size() - 16))) {
    if (record.opcode == 6) ++chunks;
  }
  EXPECT_EQ(chunks, 5u);
}

}  // namespace peerd::mcap_writer_test
