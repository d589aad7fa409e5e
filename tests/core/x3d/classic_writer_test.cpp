#include "core/x3d/classic_writer.hpp"

#include <gmock/gmock.h>

#include "core/vrml/lexer.hpp"
#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::classic_writer_test {

using testing::ElementsAre;

struct Writing {
  Problems problems;
  std::string xml = std::string(100, ' ');  // holds all places that are reported
  ClassicWriter writer{problems.open({"a.x3d", xml, nullptr}).value(), problems};

  std::string value(std::string_view type, std::string_view raw) {
    static_cast<void>(writer.value(type, "f", raw, 0));
    return writer.take().text;
  }
  std::vector<std::string> messages() {
    std::vector<std::string> all;
    for (const Diagnostic& d : problems.take().diagnostics) all.push_back(d.message);
    return all;
  }
};

struct ValueCase {
  const char* name;
  const char* type;
  const char* raw;
  const char* text;
};
class ClassicValue : public testing::TestWithParam<ValueCase> {};
TEST_P(ClassicValue, IsWritten) {
  Writing w;
  EXPECT_EQ(w.value(GetParam().type, GetParam().raw), GetParam().text);
  EXPECT_THAT(w.messages(), testing::IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Table, ClassicValue,
                         testing::Values(ValueCase{"Numbers", "MFVec2f", " 1,2\n3 4e-1", "[  1,2\n3 4e-1 ] "},
                                         ValueCase{"OneNumber", "SFFloat", "+.5", "+.5 "},
                                         ValueCase{"Hexadecimal", "SFInt32", "0xFF", "0xFF "},
                                         ValueCase{"NumbersOfEntities", "SFVec2f", "1&#32;2", "1 2 "},
                                         ValueCase{"NoNumbers", "MFFloat", "", "[  ] "},
                                         ValueCase{"Flag", "SFBool", " true ", "TRUE "},
                                         ValueCase{"Flags", "MFBool", "true,false", "[ TRUE FALSE ] "},
                                         ValueCase{"String", "SFString", "a \"b\" \\ c &lt;&amp;&quot;&#x41;&#228;",
                                                   "\"a \\\"b\\\" \\\\ c <&\\\"A\xC3\xA4\" "},
                                         ValueCase{"StringOfEscapes", "SFString", "\\\"a\\\\", "\"\\\"a\\\\\" "},
                                         ValueCase{"StringOfLines", "SFString", "a\r\nb\tc&#10;d", "\"a b c\nd\" "},
                                         ValueCase{"Strings", "MFString", "\"a\",&quot;b # c&quot; \"d\\\"\"",
                                                   "[ \"a\" \"b # c\" \"d\\\"\" ] "},
                                         ValueCase{"NoNode", "SFNode", "NULL", "NULL "}),
                         [](const auto& of) { return std::string(of.param.name); });

class WrongClassicValue : public testing::TestWithParam<ValueCase> {};
TEST_P(WrongClassicValue, IsNamedAndLeftOut) {
  Writing w;
  EXPECT_EQ(w.value(GetParam().type, GetParam().raw), "");
  EXPECT_THAT(w.messages(), ElementsAre(testing::HasSubstr(GetParam().text)));
}
INSTANTIATE_TEST_SUITE_P(
    Table, WrongClassicValue,
    testing::Values(ValueCase{"Brace", "SFFloat", "1} Box {", "wants numbers, found '1}'"},
                    ValueCase{"Word", "SFVec3f", "1 2 3 center 4 5 6", "wants numbers, found 'center'"},
                    ValueCase{"Comment", "MFFloat", "1 # 2", "wants numbers, found '#'"},
                    ValueCase{"TooFew", "SFVec3f", "1 2", "wants 3 numbers, found 2"},
                    ValueCase{"TooMany", "SFFloat", "1 2", "wants a number, found 2"},
                    ValueCase{"Flag", "SFBool", "yes", "wants true or false, found 'yes'"},
                    ValueCase{"NoFlag", "SFBool", "", "wants true or false, found ''"},
                    ValueCase{"Entity", "SFFloat", "&bomb;", "no entity is known that begins '&bomb;'"},
                    ValueCase{"Node", "MFNode", "Box", "takes nodes"}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(ClassicWriter, TakesAStringWithoutQuotesForOne) {
  Writing w;
  EXPECT_EQ(w.value("MFString", "a.png"), "[ \"a.png\" ] ");
  EXPECT_THAT(w.messages(), ElementsAre("'f' (MFString) wants strings in quotes, found 'a.png'"));
}

// XML has no comments in attributes.
TEST(ClassicWriter, TakesNoSignBetweenStringsForAComment) {
  Writing w;
  EXPECT_EQ(w.value("MFString", "\"a\" # \"b\""), "[ \"\\\"a\\\" # \\\"b\\\"\" ] ");
  EXPECT_THAT(w.messages(), ElementsAre("'f' (MFString) wants strings in quotes, found '\"a\" # \"b\"'"));
}

TEST(ClassicWriter, WritesAnyNameAsOneToken) {
  for (const std::string_view name : {"a", "a.b c", "x Box {", "1", "\"", "#", "-"}) {
    Writing w;
    w.writer.name(name, 0);
    w.writer.word("next", 0);
    const ClassicText made = w.writer.take();
    Lexer lexer(made.text, 0, true);
    EXPECT_EQ(lexer.next().text, name);
    EXPECT_EQ(lexer.next().text, "next");
  }
}

TEST(ClassicWriter, KnowsWhereItsTextCameFrom) {
  Writing w;
  w.writer.word("size", 10);
  const std::size_t value = w.writer.size();
  ASSERT_TRUE(w.writer.value("SFVec3f", "size", "1 22 3", 20));
  const ClassicText made = w.writer.take();
  EXPECT_EQ(made.map.original_of(0), 10U);
  EXPECT_EQ(made.map.original_of(3), 10U);
  EXPECT_EQ(made.map.original_of(static_cast<std::uint32_t>(value + 2)), 22U);
}

}  // namespace peerd::vrml::classic_writer_test
