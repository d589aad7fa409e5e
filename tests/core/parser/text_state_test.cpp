#include "core/parser/text_state.hpp"

#include <gmock/gmock.h>

#include "tests/core/parser/text_fixture.hpp"

namespace peerd::vrml::text_state_test {

using testing::ElementsAre;

TEST(TextState, KnowsUnreadableNamesButNoEmptyOne) {
  TextFixture t("");
  t.state.define_unreadable(std::vector<std::string_view>{"LOST", ""});
  ASSERT_NE(t.scope.names.find("LOST"), nullptr);
  EXPECT_EQ((*t.scope.names.find("LOST"))->node, NodeRef::kNull);
  EXPECT_EQ(t.scope.definitions.size(), 1u);
}

TEST(TextState, DefinesTheNamesThatItPassesOver) {
  TextFixture t("{ DEF A Group { children [ DEF B Group { } ] } } Shape");
  t.state.skip_balanced();
  EXPECT_NE(t.scope.names.find("A"), nullptr);
  EXPECT_NE(t.scope.names.find("B"), nullptr);
  EXPECT_TRUE(t.state.tokens.at_word("Shape"));
}

TEST(TextState, IsInTheWorldUnlessAPrototypesBodyIsOpen) {
  TextFixture t("");
  EXPECT_TRUE(t.state.in_world_body());
  Prototype prototype;
  Scope inner{.outer = &t.scope, .body = &prototype.body};
  t.state.scope = &inner;
  EXPECT_FALSE(t.state.in_world_body());
}

TEST(TextState, ReportsTooManyFields) {
  TextFixture t("");
  t.state.report_too_many_fields(0);
  EXPECT_THAT(t.messages(), ElementsAre("with this field there are more than 4096, more than this reader takes"));
}

}  // namespace peerd::vrml::text_state_test
