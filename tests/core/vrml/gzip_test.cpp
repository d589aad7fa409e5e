// These tests are about packed files (RFC 1952; ISO/IEC 14772-1:1997, 4.5, lets any file be one).
#include "core/vrml/gzip.hpp"

#include <gmock/gmock.h>

#include <random>

#include "tests/core/gzip_text.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::gzip_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kPlenty = 1u << 30;

std::string noise(std::size_t size) {
  std::mt19937 random(42);
  std::string out(size, '\0');
  for (char& c : out) c = static_cast<char>(random() & 0xFF);
  return out;
}

TEST(Gunzip, GivesBackWhatWasPacked) {
  for (const std::string& text : {std::string(), std::string("a"), std::string(1'000'000, 'x'), noise(300'000)}) {
    for (const int level : {0, 1, 9}) EXPECT_TRUE(gunzip(gzipped(text, level), kPlenty) == text) << text.size();
  }
}

TEST(Gunzip, ReadsAllMembers) {  // RFC 1952, 2.2
  const std::string big = noise(100'000);
  EXPECT_EQ(gunzip(gzipped("one ") + gzipped("") + gzipped("two"), kPlenty), "one two");
  EXPECT_TRUE(gunzip(gzipped(big) + gzipped(big), kPlenty) == big + big);
}

TEST(Gunzip, PassesOverPadding) {
  EXPECT_EQ(gunzip(gzipped("text") + std::string(512, '\0'), kPlenty), "text");
  EXPECT_EQ(gunzip(gzipped("text") + "\x1f", kPlenty), "text");
}

TEST(Gunzip, RefusesEveryPrefix) {
  const std::string packed = gzipped("some text to cut " + noise(200));
  for (std::size_t size = 2; size < packed.size(); ++size) {
    const auto result = gunzip(packed.substr(0, size), kPlenty);
    ASSERT_FALSE(result.has_value()) << size;
    EXPECT_EQ(result.error(), "the gzip file ends in the middle") << size;
  }
  EXPECT_FALSE(gunzip(gzipped("one") + gzipped("two").substr(0, 8), kPlenty).has_value());
}

// The CRC and the size behind the data catch every single bit there and in the data; but for the few that only pad.
TEST(Gunzip, RefusesEveryFlippedBitThatMatters) {
  const std::string packed = gzipped("some text to damage");
  for (std::size_t i = 10; i < packed.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = packed;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      const auto result = gunzip(damaged, kPlenty);
      if (i + 8 < packed.size() && result) {
        EXPECT_EQ(*result, "some text to damage") << i << ' ' << bit;
      } else {
        EXPECT_FALSE(result.has_value()) << i << ' ' << bit;
      }
    }
  }
  EXPECT_THAT(gunzip("\x1f\x8b\x07" + gzipped("x").substr(3), kPlenty).error(), HasSubstr("damaged"));
}

TEST(Gunzip, StopsAtTheLimit) {
  const std::string packed = gzipped(std::string(1000, 'x'));
  EXPECT_EQ(gunzip(packed, 1000)->size(), 1000u);
  EXPECT_EQ(gunzip(packed, 999).error(), "it unpacks to more than 999 bytes");
  EXPECT_EQ(gunzip(packed, 0).error(), "it unpacks to more than 0 bytes");
  EXPECT_FALSE(gunzip(packed + packed, 1999).has_value());
  EXPECT_EQ(gunzip(packed + packed, 2000)->size(), 2000u);
}

// A hundred kilobytes stand for a hundred megabytes: the text is refused when the limit is passed, not when all is
// there.
TEST(Gunzip, RefusesBombs) {
  EXPECT_THAT(gunzip(gzipped(std::string(100'000'000, ' '), 9), 1'000'000).error(),
              HasSubstr("more than 1000000 bytes"));
}

TEST(PackedWorld, IsReadAsItsText) {
  const std::string text = world_text("Shape { geometry Box { } }\nShpae { }");
  const std::string packed = gzipped(text);
  const ReadResult result = read_world(packed);
  EXPECT_THAT(lines_of(result), ElementsAre("3:1: unknown node type 'Shpae', did you mean 'Shape'?"));
  EXPECT_EQ(result.sources.at(0).text, text);
  EXPECT_THAT(render(result, result.diagnostics[0]), HasSubstr("Shpae { }\n^"));
  EXPECT_EQ(content_hash(result), content_hash(read_world(text)));
}

TEST(PackedWorld, MayHavePackedPartsOfAnyName) {
  const Scene scene = scene_of(
      "Inline { url \"a.wrl\" } Inline { url \"b.wrl.gz\" } Inline { url \"c.wrz\" } EXTERNPROTO P [ ] \"p.wrl#P\" P { "
      "}",
      {{"a.wrl", gzipped(world_text("DEF A Shape { }"))},
       {"b.wrl.gz", gzipped(world_text("DEF B Shape { }"))},
       {"c.wrz", "DEF C Shape { }"},
       {"p.wrl", gzipped(world_text("PROTO P [ ] { Shape { } }"))}});
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/A", "1", "1/B", "2", "2/C", "3"));
}

TEST(PackedWorld, SaysWhatIsWrongWithIt) {
  const std::string packed = gzipped(world_text("Group { }"));
  EXPECT_THAT(lines_of(read_world(packed.substr(0, packed.size() - 5))),
              ElementsAre("1:1: the gzip file ends in the middle"));
  EXPECT_THAT(lines_of(read_world(gzipped("Group { }"))),
              ElementsAre(HasSubstr("1:1: the first line must begin with")));
  EXPECT_THAT(lines_of(read_world(gzipped(""))), ElementsAre(HasSubstr("1:1: the file is empty")));
  EXPECT_THAT(lines_of(read_world(gzipped(packed))), ElementsAre(HasSubstr("1:1: the first line must begin with")));
  EXPECT_THAT(problems_of("Group { }\nInline { url \"a\" }", {{"a", packed.substr(0, 15)}}),
              ElementsAre("warning 3:14: this Inline stays empty: 'a': the gzip file ends in the middle"));
}

TEST(PackedWorld, CountsUnpacked) {
  ReadOptions options;
  options.limits.text_bytes = 1000;
  const std::string packed = gzipped(world_text(std::string(5000, ' ')));
  EXPECT_THAT(lines_of(read_world(packed, options)), ElementsAre(HasSubstr("it unpacks to more than 1000 bytes")));
  EXPECT_THAT(problems_of("Inline { url \"a\" }", {{"a", packed}}, options),
              ElementsAre(HasSubstr("'a': it unpacks to more than")));
  EXPECT_THAT(errors_of("Inline { url \"a\" }", {{"a", gzipped(world_text("Shape { }"))}}, options), IsEmpty());
}

TEST(PackedWorld, UnpacksToAMultipleOfItsSize) {
  const std::string packed = gzipped(world_text(std::string((1U << 24) + 600'000, ' ')));  // packed to 17 kB
  ASSERT_LT(64 * packed.size(), 2'000'000U);
  ASSERT_GT(64 * packed.size(), 600'000U) << "it fits";
  EXPECT_THAT(lines_of(read_world(packed)), IsEmpty());
  const std::string bomb = gzipped(world_text(std::string(1U << 26, ' ')));
  EXPECT_THAT(lines_of(read_world(bomb)),
              ElementsAre(HasSubstr("it unpacks to more than " + std::to_string((1U << 24) + 64 * bomb.size()) +
                                    " bytes; the option expansion allows more")));
  ReadOptions options;
  options.limits.expansion = 4;
  EXPECT_THAT(lines_of(read_world(bomb, options)), IsEmpty());
}

}  // namespace peerd::gzip_test
