#include "peerd/peer/record/pcapng.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace peerd::record::pcapng_test {

using testing::HasSubstr;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

struct Packet {
  LinkType link;
  std::int64_t ns;
  Direction direction;
  std::string bytes;
  bool operator==(const Packet&) const = default;
};

struct Read {
  std::vector<Packet> packets;
  bool cut_off = false;
  std::string error;
};

Read read(std::string_view file) {
  PcapngReader reader(bytes_of(file));
  Read out;
  for (;;) {
    const auto packet = reader.next();
    if (!packet) {
      out.error = packet.error();
      return out;
    }
    if (!*packet) break;
    const auto bytes = (*packet)->bytes;
    out.packets.push_back({(*packet)->link, (*packet)->at.time_since_epoch().count(), (*packet)->direction,
                           std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())});
  }
  out.cut_off = reader.cut_off();
  return out;
}

const std::vector<Packet> kPackets{{LinkType::kRawIp, 1, Direction::kIn, "a"},
                                   {LinkType::kUser0, 1'700'000'000'123'456'789, Direction::kOut, "four"},
                                   {LinkType::kRawIp, 1'700'000'000'123'456'789, Direction::kUnknown, ""}};

std::string written() {
  std::ostringstream out;
  PcapngWriter writer(out, "test", "a comment");
  writer.interface(LinkType::kRawIp, "one", "");
  writer.interface(LinkType::kUser0, "two", "the second");
  for (const Packet& p : kPackets) {
    writer.packet(p.link == LinkType::kRawIp ? 0 : 1, HostTime{Duration{p.ns}}, p.direction, bytes_of(p.bytes));
  }
  return out.str();
}

// The offsets of the file's blocks, by their lengths.
std::vector<std::size_t> blocks_of(const std::string& file) {
  std::vector<std::size_t> begins;
  for (std::size_t at = 0; at < file.size();) {
    begins.push_back(at);
    std::uint32_t length = 0;
    std::memcpy(&length, file.data() + at + 4, sizeof length);
    at += length;
  }
  return begins;
}

std::string block(std::uint32_t type, std::string body) {
  body.resize((body.size() + 3) / 4 * 4);
  const auto length = static_cast<std::uint32_t>(body.size() + 12);
  const auto raw = [](std::uint32_t n) { return std::string(reinterpret_cast<const char*>(&n), sizeof n); };
  return raw(type) + raw(length) + body + raw(length);
}

TEST(Pcapng, WhatIsWrittenIsRead) {
  const Read back = read(written());
  EXPECT_EQ(back.error, "");
  EXPECT_EQ(back.packets, kPackets);
  EXPECT_FALSE(back.cut_off);
}

TEST(Pcapng, BlocksOfOtherTypesArePassedOver) {
  std::string file = written();
  file.insert(blocks_of(file)[3], block(5, "statistics") + block(0x80000001, "") + block(0xBAD, "custom"));
  EXPECT_EQ(read(file).packets, kPackets);
}

// A machine of the other byte order writes the same numbers with swapped bytes.
TEST(Pcapng, AFileOfTheOtherByteOrderIsRead) {
  std::string file;
  const auto put32 = [&](std::uint32_t n) {
    n = __builtin_bswap32(n);
    file.append(reinterpret_cast<const char*>(&n), sizeof n);
  };
  const auto put16 = [&](std::uint16_t n) {
    n = __builtin_bswap16(n);
    file.append(reinterpret_cast<const char*>(&n), sizeof n);
  };
  put32(0x0A0D0D0A), put32(28), put32(0x1A2B3C4D), put16(1), put16(0), put32(~0u), put32(~0u), put32(28);
  put32(1), put32(28), put16(101), put16(0), put32(0), put16(9), put16(1);
  file += std::string("\x09\0\0\0", 4);
  put32(28);
  put32(6), put32(48), put32(0), put32(1), put32(2), put32(3), put32(3);
  file += std::string("abc\0", 4);
  put16(2), put16(4), put32(2), put32(0), put32(48);
  const Read back = read(file);
  EXPECT_EQ(back.error, "");
  EXPECT_EQ(back.packets,
            (std::vector<Packet>{{LinkType::kRawIp, (std::int64_t{1} << 32) + 2, Direction::kOut, "abc"}}));
}

// Wherever the writer was stopped, the whole packets count.
TEST(Pcapng, AFileThatIsCutOffGivesThePacketsBeforeTheCut) {
  const std::string file = written();
  const auto begins = blocks_of(file);
  ASSERT_EQ(begins.size(), 3 + kPackets.size());
  for (std::size_t size = begins[1]; size < file.size(); ++size) {
    const Read back = read(file.substr(0, size));
    const auto whole = static_cast<std::size_t>(std::ranges::upper_bound(begins, size) - begins.begin()) - 1;
    EXPECT_EQ(back.error, "");
    EXPECT_EQ(back.packets.size(), whole < 3 ? 0 : whole - 3) << "of " << size << " bytes";
    EXPECT_EQ(back.cut_off, !std::ranges::binary_search(begins, size)) << "of " << size << " bytes";
  }
}

// The magic number of a section header ends at byte 12: a shorter file must not be read beyond its end, where a test
// lays out bytes that would change the result.
TEST(Pcapng, ASectionHeaderThatEndsWithinItsMagicIsNotReadBeyondTheEnd) {
  const std::string section = written().substr(0, 12), rubbish(8, '\x7F');
  for (std::size_t size = 8; size < 12; ++size) {
    const Read alone = read(std::string_view(section).substr(0, size));
    EXPECT_THAT(alone.error, HasSubstr("no pcapng file")) << size << " bytes, followed by the rest of the magic";
    const std::string file = written() + section.substr(0, size), around = file + rubbish;
    const Read after = read(std::string_view(around).substr(0, file.size()));
    EXPECT_EQ(after.error, "") << size << " bytes after a whole file, followed by rubbish";
    EXPECT_TRUE(after.cut_off);
    EXPECT_EQ(after.packets.size(), kPackets.size());
  }
}

struct Wrong {
  const char* name;
  std::string (*make)();
  const char* why;
};
class PcapngRefuses : public testing::TestWithParam<Wrong> {};
TEST_P(PcapngRefuses, SayingWhereAndWhy) {
  const Read back = read(GetParam().make());
  EXPECT_THAT(back.error, HasSubstr(GetParam().why));
  EXPECT_THAT(back.error, HasSubstr("at byte "));
}

std::string with_byte(std::size_t block_number, std::size_t at, char value) {
  std::string file = written();
  file[blocks_of(file)[block_number] + at] = value;
  return file;
}

INSTANTIATE_TEST_SUITE_P(
    Table, PcapngRefuses,
    testing::Values(Wrong{"Text", [] { return std::string("This is a text, and no capture."); }, "no pcapng file"},
                    Wrong{"AFewBytes", [] { return std::string("abc"); }, "no pcapng file"},
                    Wrong{"PacketFirst", [] { return block(6, std::string(20, '\0')); }, "no pcapng file"},
                    Wrong{"Version2", [] { return with_byte(0, 12, 2); }, "version 2"},
                    Wrong{"TwoSections", [] { return written() + written(); }, "second section"},
                    Wrong{"Microseconds", [] { return with_byte(1, 28, 6); }, "nanoseconds"},
                    Wrong{"NoSuchInterface", [] { return with_byte(3, 8, 2); }, "not described"},
                    Wrong{"PartOfAPacket", [] { return with_byte(4, 24, 9); }, "in part"},
                    Wrong{"LongerThanItsBlock", [] { return with_byte(4, 20, 99); }, "longer than its block"},
                    Wrong{"LengthsDiffer", [] { return with_byte(3, 4, 48 + 4); }, "differ"},
                    Wrong{"LengthOfNoBlock", [] { return with_byte(3, 4, 8); }, "a block of 8 bytes"},
                    Wrong{"Year2262", [] { return with_byte(3, 15, '\x80'); }, "2262"},
                    Wrong{"LongOption", [] { return with_byte(3, 34, 99); }, "option is longer"}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::record::pcapng_test
