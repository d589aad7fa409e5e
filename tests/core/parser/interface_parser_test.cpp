// These tests are about the interface of a PROTO (ISO/IEC 14772-1:1997, 4.8.2).
#include "core/parser/interface_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::interface_parser_test {

using testing::ElementsAre;
using testing::HasSubstr;

class BadInterface : public testing::TestWithParam<BadCase> {};
TEST_P(BadInterface, IsReportedWhereItIs) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }

INSTANTIATE_TEST_SUITE_P(
    Missing, BadInterface,
    testing::Values(
        BadCase{"Interface",
                "PROTO P { Group { } }\nGroup { x }",
                {"2:9: expected '[' and the interface of 'P', found '{'", "3:9: Group has no field 'x'"}},
        BadCase{"Body", "PROTO P [ ]\nGroup { }", {"3:1: expected '{' and the body of 'P', found 'Group'"}},
        BadCase{
            "NodeInTheBody",
            "PROTO P [ ] { }\nP { }",
            {"warning 2:13: the body of 'P' has no node, so its instances are none either; the standard wants one"}},
        BadCase{"EverythingAtTheEnd",
                "PROTO P",
                {"2:8: expected '[' and the interface of 'P', found the end of the file",
                 "2:8: expected '{' and the body of 'P', found the end of the file"}},
        BadCase{"ClosingBracket",
                "PROTO P [ field SFBool a TRUE { Group { } }\nP { } Shpae { }",
                {"2:31: expected eventIn, eventOut, field, exposedField or ']' in the interface of 'P', found '{'",
                 "3:7: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"ClosingBrace", "PROTO P [ ] { Group { }\n", {"2:13: this PROTO is never closed: a '}' is missing"}},
        BadCase{"Type",
                "PROTO P [ field a TRUE ] { Group { } }\nShpae { }",
                {"2:17: expected a field type, found 'a'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"MisspeltType",
                "PROTO P [ field SFVec3 a 0 0 0 field SFBool b TRUE ] { Group { } }\nP { b FALSE }",
                {"2:17: expected a field type, found 'SFVec3', did you mean 'SFVec3f'?"}},
        BadCase{
            "FieldName",
            "PROTO P [ eventIn SFBool ] { Group { } }\nShpae { }",
            {"2:26: expected the name of a field, found ']'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"DefaultValue",
                "PROTO P [ field SFFloat a field SFBool b TRUE ] { Group { } }\nP { b FALSE }",
                {"2:27: 'a' (SFFloat) wants a number, found 'field'"}},
        BadCase{"Access",
                "PROTO P [ SFBool a TRUE ] { Group { } }\nP { } Shpae { }",
                {"2:11: expected eventIn, eventOut, field, exposedField or ']' in the interface of 'P', found 'SFBool'",
                 "3:7: unknown node type 'Shpae', did you mean 'Shape'?"}},
        // An event has no value (4.3.5).
        BadCase{"NothingButAValueTooMuch",
                "PROTO P [ eventIn SFBool a TRUE ] { Group { } }\nShpae { }",
                {"2:28: expected eventIn, eventOut, field, exposedField or ']' in the interface of 'P', found 'TRUE'",
                 "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(Interface, OfAnExposedFieldTakesItsEventNamesToo) {  // 4.7
  EXPECT_THAT(problems_of("PROTO P [ exposedField SFBool a TRUE eventOut SFBool a_changed ] { Group { } }"),
              ElementsAre(HasSubstr("'a_changed' is in the interface of 'P' already")));
  EXPECT_THAT(problems_of("PROTO P [ eventIn SFBool set_a exposedField SFBool a TRUE ] { Group { } }"),
              ElementsAre(HasSubstr("'a' is in the interface of 'P' already")));
  // A plain field has no events, so their names are free.
  EXPECT_THAT(problems_of("PROTO P [ field SFBool a TRUE eventIn SFBool set_a ] { Group { } }"), testing::IsEmpty());
}

}  // namespace peerd::vrml::interface_parser_test
