#include "peerd/lab/cluster/bytes.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

namespace peerd::cluster::bytes_test {

template <class T>
std::string written(const T& value) {
  ByteWriter writer;
  writer(value);
  return writer.take();
}

template <class T>
std::optional<T> read(std::string_view bytes) {
  ByteReader reader(bytes);
  T value{};
  reader(value);
  if (!reader.complete()) return std::nullopt;
  return std::optional<T>(std::in_place, std::move(value));  // T may be an optional itself
}

TEST(Bytes, DoublesComeBackBitForBit) {
  const double signalling = std::bit_cast<double>(0x7ff0'0000'0000'0001U);
  const double payload = std::bit_cast<double>(0xfff8'1234'5678'9abcU);
  for (const double x : {0.0, -0.0, 0.1, 5e-324, std::numeric_limits<double>::max(),
                         -std::numeric_limits<double>::infinity(), signalling, payload}) {
    const auto again = read<double>(written(x));
    ASSERT_TRUE(again);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*again), std::bit_cast<std::uint64_t>(x));
  }
}

TEST(Bytes, AreLittleEndianWithoutPadding) {
  EXPECT_EQ(written(std::uint32_t{0x01020304}), "\x04\x03\x02\x01");
  EXPECT_EQ(written(std::string("ab")), std::string("\2\0\0\0\0\0\0\0ab", 10));
  EXPECT_EQ(written(std::pair(true, std::uint16_t{7})), std::string("\1\7\0", 3));
}

TEST(Bytes, ListsAndMapsComeBack) {
  using Map = std::map<std::string, std::vector<std::optional<std::int32_t>>>;
  const Map map{{"", {}}, {"a", {1, std::nullopt, -3}}, {std::string("\0z", 2), {std::nullopt}}};
  EXPECT_EQ(read<Map>(written(map)), map);
}

TEST(Bytes, JsonKeepsOrderAndKinds) {
  nlohmann::ordered_json json{
      {"z", 1}, {"a", {true, nullptr, "x", -0.0, 1.0, 18446744073709551615U}}, {"m", {{"k", -5}}}};
  json["nan"] = std::numeric_limits<double>::quiet_NaN();
  const auto again = read<nlohmann::ordered_json>(written(json));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->dump(), json.dump());
  EXPECT_TRUE((*again)["nan"].is_number_float());
  EXPECT_EQ((*again)["a"][5].type(), json["a"][5].type());
}

TEST(Bytes, ACutOffValueIsRefused) {
  const std::string whole = written(std::map<std::string, double>{{"a", 1.0}, {"b", 2.0}});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE((read<std::map<std::string, double>>(std::string_view(whole).substr(0, size)))) << size;
  }
  EXPECT_FALSE((read<std::map<std::string, double>>(whole + "x")));
}

TEST(Bytes, ACountBeyondTheBytesIsRefusedBeforeAnythingIsMade) {
  const std::string huge = written(std::uint64_t{1} << 60) + "abc";
  EXPECT_FALSE(read<std::string>(huge));
  EXPECT_FALSE(read<std::vector<std::string>>(huge));
  EXPECT_FALSE(read<nlohmann::ordered_json>("\6" + huge));
}

TEST(Bytes, WhatIsNeverWrittenIsRefused) {
  EXPECT_FALSE(read<bool>("\2"));
  EXPECT_FALSE(read<std::optional<bool>>(std::string("\2\0", 2)));
  EXPECT_FALSE(read<nlohmann::ordered_json>("\x08")) << "no kind of JSON";
  const std::string key = written(std::string("k"));
  const std::string twice = std::string("\2\0\0\0\0\0\0\0", 8) + key + '\1' + key + '\1';
  EXPECT_FALSE((read<std::map<std::string, bool>>(twice))) << "a key twice";
  const std::string null_twice = std::string("\7\2\0\0\0\0\0\0\0", 9) + key + '\0' + key + '\0';
  EXPECT_FALSE(read<nlohmann::ordered_json>(null_twice)) << "a key twice";
}

TEST(Bytes, DeepJsonIsRefused) {
  const auto nested = [](int depth) {
    std::string bytes;
    for (int i = 0; i < depth; ++i) bytes += std::string("\6\1\0\0\0\0\0\0\0", 9);
    return bytes + '\0';
  };
  EXPECT_TRUE(read<nlohmann::ordered_json>(nested(kJsonDepthMax)));
  EXPECT_FALSE(read<nlohmann::ordered_json>(nested(kJsonDepthMax + 1)));
  EXPECT_FALSE(read<nlohmann::ordered_json>(nested(1'000'000)));
}

}  // namespace peerd::cluster::bytes_test
