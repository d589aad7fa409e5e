// Numbers have two readers: a fast one for the plain kind and a right one for all. Where the fast one answers, it must
// answer the same bits. The right one is held against the C library's correctly rounded strtof.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "core/vrml/lexer.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::vrml::number_test {

std::uint32_t bits(float f) { return std::bit_cast<std::uint32_t>(f); }

// Returns whether the fast reader took the number; fails where it took it otherwise than read_float() does.
bool agrees(const std::string& text) {
  float fast = 0;
  const char* const end = scan_plain(text.data(), text.data() + text.size(), fast);
  const auto right = read_float(text);
  if (end != nullptr) {
    EXPECT_EQ(end, text.data() + text.size()) << text;
    EXPECT_TRUE(right.has_value()) << text;
    if (right) {
      EXPECT_EQ(bits(fast), bits(*right)) << text;
    }
  }
  if (right) {
    EXPECT_EQ(bits(*right), bits(std::strtof(text.c_str(), nullptr))) << text;
  }
  return end != nullptr;
}

TEST(Numbers, AgreeOnRandomDecimals) {
  std::mt19937_64 random(1);
  int fast = 0;
  for (int i = 0; i < 2'000'000 && !testing::Test::HasFailure(); ++i) {
    char text[64];
    const double value = std::ldexp(static_cast<double>(random() >> 11), static_cast<int>(random() % 80) - 90);
    std::snprintf(text, sizeof text, random() % 2 == 0 ? "%.*g" : "%.*f", static_cast<int>(random() % 12), value);
    fast += static_cast<int>(agrees((random() % 2 == 0 ? "-" : "") + std::string(text)));
  }
  EXPECT_GT(fast, 1'000'000) << "most are of the plain kind";
}

TEST(Numbers, AgreeOnRandomSpellings) {
  std::mt19937_64 random(2);
  const auto digits = [&](std::uint64_t most) {
    std::string out;
    for (std::uint64_t n = random() % (most + 1); n > 0; --n) out += static_cast<char>('0' + random() % 10);
    return out;
  };
  for (int i = 0; i < 2'000'000 && !testing::Test::HasFailure(); ++i) {
    std::string text = random() % 3 == 0 ? "-" : random() % 7 == 0 ? "+" : "";
    text += digits(random() % 4 == 0 ? 25 : 6);
    if (random() % 3 != 0) text += "." + digits(random() % 4 == 0 ? 25 : 8);
    if (random() % 3 == 0)
      text += std::string(random() % 2 == 0 ? "e" : "E") +
              (random() % 3 == 0   ? "+"
               : random() % 2 == 0 ? "-"
                                   : "") +
              digits(3);
    agrees(text);
  }
}

// Just between two neighbouring binary32, and a hair above and below: exact decimals of up to 40 digits.
TEST(Numbers, AgreeOnTies) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 300'000 && !testing::Test::HasFailure(); ++i) {
    const auto below = std::bit_cast<float>(static_cast<std::uint32_t>(random() % 0x7F7FFFFF));
    const double tie = (static_cast<double>(below) +
                        static_cast<double>(std::nextafter(below, std::numeric_limits<float>::infinity()))) /
                       2;
    char text[400];
    std::snprintf(text, sizeof text, "%.200g", tie);
    agrees(text);
    std::snprintf(text, sizeof text, "%.*e", 15 + static_cast<int>(random() % 6), tie);
    agrees(text);
    std::snprintf(text, sizeof text, "%.*g", 6 + static_cast<int>(random() % 5), static_cast<double>(below));
    agrees(text);
  }
  // Short enough for the fast reader: integers and halves between neighbours above 2^24.
  for (std::uint64_t n = (1u << 24) - 1000; n < (1u << 24) + 100'000; ++n) agrees(std::to_string(n));
  for (std::uint64_t n = 0; n < 100'000; ++n) agrees(std::to_string((std::uint64_t{1} << 26) + n) + ".0");
  for (std::uint64_t n = 0; n < 100'000; ++n) agrees(std::to_string((std::uint64_t{1} << 53) - 50'000 + n));
  for (std::uint64_t n = 0; n < 50'000; ++n) agrees(std::to_string(8'388'608 + n) + ".5");
  for (std::uint64_t n = 0; n < 50'000; ++n) agrees(std::to_string(4'194'304 + n) + ".25");
}

struct Spelling {
  const char* text;
  float value;
};
TEST(Numbers, ReadNastySpellings) {
  const float denorm = std::numeric_limits<float>::denorm_min();
  for (const auto& [text, value] :
       {Spelling{"1.", 1},
        {".5", 0.5f},
        {"5.e-1", 0.5f},
        {"+1", 1},
        {"+.5", 0.5f},
        {"-.5", -0.5f},
        {"-0", -0.0f},
        {"-0.0", -0.0f},
        {"0e99999", 0},
        {"-0e-99999", -0.0f},
        {"1e-45", denorm},
        {"7e-46", 0},
        {"8e-46", denorm},
        {"-8e-46", -denorm},
        {"1.17549435e-38", std::numeric_limits<float>::min()},
        {"1.1754942e-38", std::nextafter(std::numeric_limits<float>::min(), 0.0f)},
        {"3.4028235e38", std::numeric_limits<float>::max()},
        {"3.4028235677973366e38", std::numeric_limits<float>::max()},  // overflows at .. 37..
        {"0.000000000000000000000000000000000000000000001e45", 1},
        {"1000000000000000000000000000000000000000000000e-45", 1},
        {"00000000000000000000001", 1},
        {"1e+0005", 1e5f},
        {"1e-0005", 1e-5f},
        {"9007199254740993", 9007199254740992.0f},
        {"16777217.0000000001", 16777218.0f},
        {"16777217", 16777216.0f},
        {"16777219", 16777220.0f},
        {"1.00000005960464477539062500000000001", std::nextafter(1.0f, 2.0f)},
        {"1.000000059604644775390625", 1.0f}}) {
    const auto right = read_float(text);
    ASSERT_TRUE(right.has_value()) << text;
    EXPECT_EQ(bits(*right), bits(value)) << text;
    agrees(text);
  }
}

TEST(Numbers, AreNotTakenWithWhatFollows) {
  for (const char* text :
       {"1a", "1.2.3", "0x10",  "1e",      "1e+", "1e1.5", "--1", "+-1", "1-2", "1+2", "1\"", "1{",
        "1[", "1\x01", "1\x80", "1e99999", "e5",  ".",     "-",   "-.",  "",    ".e1", "1_",  "1ee5"}) {
    float f = 0;
    EXPECT_EQ(scan_plain(text, text + std::strlen(text), f), nullptr) << text;
    std::int32_t n = 0;
    EXPECT_EQ(scan_plain(text, text + std::strlen(text), n), nullptr) << text;
  }
  for (const char* text : {"1 2", "1,2", "1]", "1}", "1\t", "1\n", "1\r"}) {
    float f = 0;
    EXPECT_EQ(scan_plain(text, text + std::strlen(text), f), text + 1) << text;
    std::int32_t n = 0;
    EXPECT_EQ(scan_plain(text, text + std::strlen(text), n), text + 1) << text;
  }
}

TEST(Numbers, OfIntegersAgree) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 2'000'000 && !testing::Test::HasFailure(); ++i) {
    std::string text = std::to_string(static_cast<std::int64_t>(random()) >> (random() % 64));
    if (random() % 8 == 0) text.insert(text.starts_with('-') ? 1 : 0, random() % 12, '0');
    std::int32_t fast = 0;
    const char* const end = scan_plain(text.data(), text.data() + text.size(), fast);
    const auto right = read_int32(text);
    const long long value = std::strtoll(text.c_str(), nullptr, 10);
    EXPECT_EQ(right.has_value(), value >= INT32_MIN && value <= INT32_MAX) << text;
    if (right) {
      EXPECT_EQ(*right, value) << text;
    }
    if (end != nullptr) {
      EXPECT_TRUE(right == fast) << text;
    }
  }
}

// The comparison is made through a world too, where the readers take turns.
TEST(Numbers, OfOneListAreReadByBoth) {
  std::string list;
  std::vector<float> expected;
  std::mt19937_64 random(5);
  const char* const spellings[] = {
      "1", "-2.5", "+3", "1e-40", "16777217", ".5", "1.", "0.1", "1.00000005960464477539062500000000001", "1e10", "-0"};
  const char* const gaps[] = {" ", ",", "\n", " # a comment 5 ]\n", "\t,\r\n"};
  for (int i = 0; i < 20'000; ++i) {
    const char* const spelling = spellings[random() % std::size(spellings)];
    expected.push_back(std::strtof(spelling, nullptr));
    list += std::string(spelling) + gaps[random() % std::size(gaps)];
  }
  const Scene scene = scene_of("ScalarInterpolator { key [ " + list + "] }");
  const auto read = scene.document->nodes.at(0).find("key")->as<float>();
  ASSERT_EQ(read.size(), expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) ASSERT_EQ(bits(read[i]), bits(expected[i])) << i;
}

TEST(Numbers, OfOneListOfIntegersAreReadByBoth) {
  const Scene scene =
      scene_of("IndexedLineSet { coordIndex [ 1 -1,0x10 +5 0XfFfFfFfF 2147483647 -2147483648 000000000012]}");
  const auto read = scene.document->nodes.at(0).find("coordIndex")->as<std::int32_t>();
  EXPECT_EQ(std::vector<std::int32_t>(read.begin(), read.end()),
            (std::vector<std::int32_t>{1, -1, 16, 5, -1, INT32_MAX, INT32_MIN, 12}));
}

TEST(Numbers, WrongOnesAreReportedWhereTheyAre) {
  EXPECT_EQ(
      errors_of("ScalarInterpolator { key [ 1 2\n 12abc 3 1e39,nan 4 # nan\n -1.#IND 5 0x10 ] }"),
      (std::vector<std::string>{"3:2: '12abc' is not a number of MFFloat", "3:10: '1e39' is too large for MFFloat",
                                "3:15: 'nan' is not a finite number", "4:2: '-1.#IND' is not a number of MFFloat",
                                "4:12: '0x10' is not a number of MFFloat"}));
  EXPECT_EQ(errors_of("IndexedLineSet { coordIndex [ 1 1.0 2147483648 0x1FFFFFFFF 1e3 ] }"),
            (std::vector<std::string>{
                "2:33: '1.0' is not a number of MFInt32", "2:37: '2147483648' is too large for MFInt32",
                "2:48: '0x1FFFFFFFF' is too large for MFInt32", "2:60: '1e3' is not a number of MFInt32"}));
}

// Found by fuzzing: a word that spells no number was looked at for ever.
TEST(Numbers, ListsEndWhateverStandsInThem) {
  EXPECT_EQ(errors_of("IndexedFaceSet { coordIndex [ 0 nan 1 inf foo TRUE ] }").size(), 4u);
  EXPECT_EQ(errors_of("ScalarInterpolator { key [ 0 nan 1 inf foo TRUE ] }").size(), 4u);
}

TEST(Numbers, BehindWhatIsNoneAreJudgedToo) {
  EXPECT_EQ(errors_of("ScalarInterpolator { key [ 1 \"x\" 2 0x10 ] }"),
            (std::vector<std::string>{"2:30: 'key' (MFFloat) wants a number, found the string \"x'",
                                      "2:36: '0x10' is not a number of MFFloat"}));
}

}  // namespace peerd::vrml::number_test
