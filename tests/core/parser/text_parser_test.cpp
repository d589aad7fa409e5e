#include "core/parser/text_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/parser/text_fixture.hpp"

namespace peerd::vrml::text_parser_test {

using testing::IsEmpty;

struct Parsed : TextFixture {
  explicit Parsed(std::string_view text) : TextFixture("") {
    const Position begin = problems.open({"world.wrl", text, nullptr}).value();
    context.open_files.push_back("world.wrl");
    declarations = TextParser(context, {.begin = begin}, 0).parse_text(context.world);
  }
  Declarations declarations;
};

TEST(TextParser, PutsTheNodesOfATextIntoABody) {
  Parsed p("Group { } Shape { geometry Box { } }");
  EXPECT_EQ(p.context.world.roots.size(), 2u);
  EXPECT_EQ(p.context.world.nodes.size(), 3u);
  EXPECT_THAT(p.messages(), IsEmpty());
}

TEST(TextParser, GivesThePrototypesOfTheTopLevel) {
  Parsed p("PROTO A [ ] { PROTO B [ ] { Group { } } B { } } EXTERNPROTO C [ ] \"none.wrl\"");
  std::vector<std::string_view> names;
  for (const auto& [name, declaration] : p.declarations) names.push_back(name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("A", "C"));
  EXPECT_TRUE(p.declarations.at("C").external);
}

}  // namespace peerd::vrml::text_parser_test
