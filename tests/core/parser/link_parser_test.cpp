// These tests are about IS (ISO/IEC 14772-1:1997, 4.8.3 and table 4.4).
#include "core/parser/link_parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::link_parser_test {

using testing::ElementsAre;
using testing::HasSubstr;

// The rows of table 4.4 are those of the interface, the columns those of the node in the body. All fields are SFFloat.
TEST(ProtoIs, MayJoinWhatTable44Says) {
  struct Inner {
    const char* node;
    const char* field;
    bool exposed_field, field_, event_in, event_out;  // may be IS one of these of the interface
  };
  const Inner inners[] = {
      {"Appearance { material Material", "transparency", true, true, true, true},
      {"Appearance { material Material", "set_transparency", false, false, true, false},
      {"Appearance { material Material", "transparency_changed", false, false, false, true},
      {"Shape { geometry Sphere", "radius", false, true, false, false},
      {"Group { children ScalarInterpolator", "set_fraction", false, false, true, false},
      {"Group { children ScalarInterpolator", "value_changed", false, false, false, true},
  };
  for (const Inner& inner : inners) {
    const std::pair<const char*, bool> rows[] = {{"exposedField SFFloat x 1", inner.exposed_field},
                                                 {"field SFFloat x 1", inner.field_},
                                                 {"eventIn SFFloat x", inner.event_in},
                                                 {"eventOut SFFloat x", inner.event_out}};
    for (const auto& [declaration, allowed] : rows) {
      const std::string body =
          std::string("PROTO P [ ") + declaration + " ] { " + inner.node + " { " + inner.field + " IS x } } }";
      EXPECT_EQ(problems_of(body).size(), allowed ? 0u : 1u) << body;
    }
  }
}

class BadIs : public testing::TestWithParam<BadCase> {};
TEST_P(BadIs, IsReportedWhereItIs) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }

INSTANTIATE_TEST_SUITE_P(
    Table, BadIs,
    testing::Values(
        BadCase{"OtherType",
                "PROTO P [ field SFColor c 0 0 0 ] {\n Transform { translation IS c } }",
                {"3:14: 'translation' is SFVec3f and cannot be 'c', which is SFColor"}},
        BadCase{"ListForOne",
                "PROTO P [ field MFColor c 0 0 0 ] {\n Material { diffuseColor IS c } }",
                {"3:13: 'diffuseColor' is SFColor and cannot be 'c', which is MFColor"}},
        BadCase{"NotInTheInterface",
                "PROTO P [ field SFVec3f place 0 0 0 ] {\n Transform { translation IS plaec } }",
                {"3:29: the interface of 'P' has no 'plaec', did you mean 'place'?"}},
        BadCase{"OutsideOfProtos", "Group { children IS kids }", {"2:18: IS belongs inside a PROTO"}},
        BadCase{"WithoutAName",
                "PROTO P [ ] { Group { children IS } }",
                {"2:35: expected a name of the PROTO's interface after IS, found '}'"}},
        BadCase{"InAnInstanceOutsideOfProtos",
                "PROTO P [ field SFBool b TRUE ] { Group { } }\nP { b IS c }",
                {"3:7: IS belongs inside a PROTO"}},
        // 4.8.4: IS sees the innermost PROTO only.
        BadCase{"OfTheOuterProto",
                "PROTO A [ field SFVec3f p 0 0 0 ] {\n PROTO B [ ] { Transform { translation IS p } }\n B { } }",
                {"3:43: the interface of 'B' has no 'p'"}},
        BadCase{"InADefaultValue",
                "PROTO A [ field SFVec3f p 0 0 0 field SFNode n Transform { translation IS p } ] { Group { } }",
                {"2:72: IS belongs inside a PROTO"}},
        BadCase{"UnknownField",
                "PROTO P [ field SFVec3f p 0 0 0 ] { Transform { translaton IS p } }",
                {"2:49: Transform has no field 'translaton', did you mean 'translation'?"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// Results are undefined (4.8.3), so the reader reports the case.
TEST(ProtoIs, GivenTwiceIsReported) {
  EXPECT_THAT(problems_of("PROTO P [ field SFFloat a 1 field SFFloat b 2 ] {\n Shape { geometry Sphere { radius IS a "
                          "radius IS b } } }"),
              ElementsAre(HasSubstr("radius")));
  EXPECT_THAT(problems_of("PROTO P [ field SFFloat a 1 ] {\n Shape { geometry Sphere { radius 2 radius IS a } } }"),
              ElementsAre(HasSubstr("radius")));
  EXPECT_THAT(problems_of("PROTO P [ field SFFloat a 1 ] {\n Shape { geometry Sphere { radius IS a radius 2 } } }"),
              ElementsAre(HasSubstr("radius")));
}

}  // namespace peerd::vrml::link_parser_test
