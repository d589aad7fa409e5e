#include "core/parser/parse_context.hpp"

#include <gmock/gmock.h>

#include "tests/core/gzip_text.hpp"
#include "tests/core/parser/text_fixture.hpp"

namespace peerd::vrml::parse_context_test {

using testing::ElementsAre;

constexpr std::string_view kText = "#VRML V2.0 utf8\nGroup { }";

TEST(OpenText, GivesThePlaceBehindTheHeader) {
  TextFixture t("first");
  const auto opened = open_text(t.context, {"a.wrl", kText, nullptr});
  ASSERT_TRUE(opened);
  EXPECT_EQ(t.problems.text_of(opened->begin), kText);
  EXPECT_EQ(kText.substr(opened->body).find("Group"), kText.substr(opened->body).find_first_not_of(" \n"));
  EXPECT_EQ(t.context.text_bytes, kText.size());
}

TEST(OpenText, RefusesATextWithoutAHeaderAndKeepsItAmongTheSources) {
  TextFixture t("first");
  EXPECT_FALSE(open_text(t.context, {"a.wrl", "Group { }", nullptr}));
  EXPECT_EQ(t.problems.take().sources.size(), 2u);
}

TEST(ParseContext, CountsEightReferencesAsANodeAndReportsOnce) {
  TextFixture t("first");
  t.options.limits.nodes = 2;
  EXPECT_TRUE(t.context.room_for(1, 0, 0));
  EXPECT_TRUE(t.context.room_for(0, 8, 0));
  EXPECT_FALSE(t.context.room_for(0, 1, 0));
  EXPECT_FALSE(t.context.room_for(1, 0, 0));
  EXPECT_THAT(t.messages(), ElementsAre("with this node there are more than 2 nodes, PROTOs expanded"));
}

}  // namespace peerd::vrml::parse_context_test
