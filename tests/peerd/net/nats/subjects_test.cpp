#include "peerd/net/nats/subjects.hpp"

#include <gtest/gtest.h>

namespace peerd::nats::subjects_test {

TEST(Subjects, NameWorldSessionAndRegion) {
  const Subjects subjects("peerd", "town", 0x5f0c);
  EXPECT_EQ(subjects.of(RegionId{0}), "peerd.town.any.0");
  EXPECT_EQ(subjects.of(RegionId{1}), "peerd.town.0000000000005f0c.1");
  EXPECT_EQ(subjects.of(RegionId{4294967295u}), "peerd.town.0000000000005f0c.4294967295");
  EXPECT_EQ(subjects.all(), "peerd.town.0000000000005f0c.*");
}

// Another version of a world is noticed in region 0, and shares no other region.
TEST(Subjects, OfTwoVersionsOfAWorldShareRegion0Alone) {
  const Subjects one("a.b", "town", 1), other("a.b", "town", 2);
  EXPECT_EQ(one.of(RegionId{0}), other.of(RegionId{0}));
  EXPECT_NE(one.of(RegionId{7}), other.of(RegionId{7}));
}

struct Case {
  const char *name, *text, *token;
};
class Token : public testing::TestWithParam<Case> {};
TEST_P(Token, IsOneForNats) { EXPECT_EQ(token(GetParam().text), GetParam().token); }
INSTANTIATE_TEST_SUITE_P(Table, Token,
                         testing::Values(Case{"Plain", "head-on_2", "head-on_2"}, Case{"Dot", "a.b", "a%2eb"},
                                         Case{"Wildcards", "*>", "%2a%3e"}, Case{"Blank", "my town", "my%20town"},
                                         Case{"Percent", "5%", "5%25"}, Case{"Utf8", "\xc3\xa4", "%c3%a4"}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace peerd::nats::subjects_test
