#include "core/vrml/parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

NodeTree tree_of(const std::string& body) {
  static std::string text;  // the tree points into it
  text = body;
  Problems problems;
  NodeTree tree = parse(text, {}, problems);
  for (const Diagnostic& d : problems.take()) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(d, "test.wrl", text);
  }
  return tree;
}

TEST(Parser, ReadsEveryFieldType) {
  const NodeTree tree = tree_of(R"(
    Transform { enslaved TRUE rotation 0 1 0 .5 translation 1,2,3 }
    Extrusion { crossSection [ 1 2, 3 4 ] orientation [ 0 0 1 2 ] }
    Text { string [ "a" "b\"c" ] length 1.5 maxExtent 2 }
    IndexedFaceSet { coordIndex [ 0 1 2 -1, 0x10 ] }
    PixelTexture { image 2 1 3 0xFF0000 255 }
    Shape { splitThreshold 7 hierarchyFile "a.hier" }
    Group { children [ Shape { } Group { children Shape { } } ] })");
  const auto value = [&](std::size_t top, std::string_view field) -> const Value& {
    return tree.nodes[tree.top_level[top].index].find(field)->value;
  };
  EXPECT_EQ(std::get<bool>(value(0, "enslaved")), true);
  EXPECT_EQ(std::get<Floats>(value(0, "rotation")), (Floats{0, 1, 0, 0.5f}));
  EXPECT_EQ(std::get<Floats>(value(0, "translation")), (Floats{1, 2, 3, 0}));
  EXPECT_THAT(std::get<std::vector<float>>(value(1, "crossSection")), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(std::get<std::vector<float>>(value(1, "orientation")), ElementsAre(0, 0, 1, 2));
  EXPECT_THAT(std::get<std::vector<std::string>>(value(2, "string")), ElementsAre("a", "b\"c"));
  EXPECT_THAT(std::get<std::vector<float>>(value(2, "length")), ElementsAre(1.5f));
  EXPECT_THAT(std::get<std::vector<std::int32_t>>(value(3, "coordIndex")), ElementsAre(0, 1, 2, -1, 16));
  EXPECT_THAT(std::get<std::vector<std::int32_t>>(value(4, "image")), ElementsAre(2, 1, 3, 0xFF0000, 255));
  EXPECT_EQ(std::get<std::int32_t>(value(5, "splitThreshold")), 7);
  EXPECT_EQ(std::get<std::string>(value(5, "hierarchyFile")), "a.hier");
  EXPECT_EQ(std::get<std::vector<NodeRef>>(value(6, "children")).size(), 2u);
}

TEST(Parser, PutsNodesBehindAllThatTheyReferTo) {
  const NodeTree tree = tree_of("DEF A Group { children [ DEF B Shape { } Group { children USE B } ] } USE A");
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const FieldValue* children = tree.nodes[i].find("children");
    if (children == nullptr) continue;
    for (const NodeRef& ref : std::get<std::vector<NodeRef>>(children->value)) EXPECT_LT(ref.index, i);
  }
  EXPECT_EQ(tree.top_level[0].index, tree.top_level[1].index);
}

TEST(Parser, LetsALaterDefTakeOverAName) {
  const NodeTree tree = tree_of("DEF A Group { children DEF A Shape { } } USE A");
  EXPECT_EQ(tree.nodes[tree.top_level[1].index].type->name, "Shape");
}

TEST(Parser, AcceptsWhatTheStandardAllows) {
  EXPECT_THAT(problems_of(""), IsEmpty());
  EXPECT_THAT(problems_of("Group { children NULL } Shape { geometry NULL }"), IsEmpty());
  EXPECT_THAT(problems_of("Group { children [ ] } Group{children[Shape{},Shape{},]}"), IsEmpty());
  EXPECT_THAT(problems_of("Transform { rotation 0 0 0 0 }"), IsEmpty());
}

struct BadCase {
  const char* name;
  const char* body;
  std::vector<std::string> problems;
};
class BadText : public testing::TestWithParam<BadCase> {};
TEST_P(BadText, IsReportedWhereItIs) { EXPECT_EQ(problems_of(GetParam().body), GetParam().problems); }
INSTANTIATE_TEST_SUITE_P(
    Table, BadText,
    testing::Values(
        BadCase{"UnknownNode",
                "Trasform { x [ } ] }",
                {"2:1: unknown node type 'Trasform', did you mean 'Transform'?", "2:20: expected a node, found '}'"}},
        BadCase{"UnknownFieldWithNode",
                "Group { childrn DEF A Shape { apearance NULL } children USE A }",
                {"2:9: Group has no field 'childrn', did you mean 'children'?",
                 "2:31: Shape has no field 'apearance', did you mean 'appearance'?"}},
        BadCase{"MissingFieldName",
                "Transform { Shape { } }",
                {"2:13: 'Shape' is a node; the name of a field of Transform is missing before it"}},
        BadCase{
            "GeometryAmongChildren",
            "Group { children Box { } }",
            {"2:18: 'children' takes a child of a group; Box is a geometry node: write Shape { geometry Box { .. } }"}},
        BadCase{
            "GeometryAtTheTop", "Box { }", {"warning 2:1: Box at the top level is not part of the scene by itself"}},
        BadCase{"EventInWithValue",
                "Group { addChildren [ Shape { } ] children [ ] }",
                {"2:9: 'addChildren' is an eventIn of Group: a file cannot give it a value"}},
        BadCase{"FieldTwice",
                "Group { children [ ] children [ ] }",
                {"warning 2:22: 'children' is given twice; the last one counts"}},
        BadCase{"TooFewNumbers",
                "Transform { translation 1 2 rotation 0 0 1 0 }",
                {"2:29: 'translation' (SFVec3f) wants 3 numbers, found 'rotation'"}},
        BadCase{"TooManyNumbers",
                "Transform { translation 1 2 3 4 5 rotation 0 0 1 0 }",
                {"2:31: expected a field of Transform, found '4'"}},
        BadCase{"BracketsAroundOneValue",
                "Transform { translation [ 1 2 3 ] scale x }",
                {"2:25: 'translation' (SFVec3f) wants 3 numbers, found '[': it is one value, without brackets",
                 "2:41: 'scale' (SFVec3f) wants 3 numbers, found 'x'", "2:41: Transform has no field 'x'"}},
        BadCase{"NumbersNotByThree",
                "Coordinate { point [ 0 0 0 1 ] }",
                {"warning 2:1: Coordinate at the top level is not part of the scene by itself",
                 "2:20: 'point' (MFVec3f) wants numbers by 3, found 4"}},
        BadCase{"NotANumberInAList",
                "Group { bboxSize nan 1 inf children quux }",
                {"2:18: 'nan' is not a finite number", "2:24: 'inf' is not a finite number",
                 "2:37: expected a node, found 'quux'"}},
        BadCase{"TooLarge",
                "Transform { translation 1e39 0 -1e39 }",
                {"2:25: '1e39' is too large for SFVec3f", "2:32: '-1e39' is too large for SFVec3f"}},
        BadCase{"NotAnInteger", "Shape { splitThreshold 1.5 }", {"2:24: '1.5' is not a number of SFInt32"}},
        BadCase{"OutOfRange",
                "Shape { splitThreshold 0 geometry Box { size 1 -1 0 } }",
                {"2:24: 'splitThreshold' must be > 0, found '0'", "2:48: 'size' must be > 0, found '-1'",
                 "2:51: 'size' must be > 0, found '0'"}},
        BadCase{"LowerCaseTrue",
                "Transform { enslaved true remote 1 }",
                {"2:22: 'enslaved' (SFBool) wants TRUE or FALSE, found 'true'",
                 "2:34: 'remote' (SFBool) wants TRUE or FALSE, found '1'"}},
        BadCase{"ZeroAxis",
                "Transform { rotation 0 0 0 1 }",
                {"2:22: 'rotation' has an axis of length 0 and an angle that is not 0"}},
        BadCase{"MissingQuote",
                "WorldInfo { title \"a\nGroup { }",
                {"2:11: this WorldInfo is never closed: a '}' is missing",
                 "2:19: this string is never closed: a '\"' is missing"}},
        BadCase{"MissingBrace", "Group { children Shape { }\n", {"2:7: this Group is never closed: a '}' is missing"}},
        BadCase{"MissingBracket",
                "Group { children [ Shape { } }\nShpae { }",
                {"2:30: expected ']', found '}'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"MissingBracketBeforeField",
                "Coordinate { point [ 0 0 0 point [ 1 1 1 ] }",
                {"warning 2:1: Coordinate at the top level is not part of the scene by itself",
                 "2:28: expected ']', found 'point'"}},
        BadCase{"MissingBraceInList",
                "Group { children [ Transform { translation 1 2 3 ] } Box",
                {"2:50: expected a field of Transform or its '}', found ']'",
                 "2:57: expected '{' after Box, found the end of the file"}},
        BadCase{"StrayBrackets",
                "} Group { ] } ]",
                {"2:1: expected a node, found '}'", "2:11: expected a field of Group or its '}', found ']'",
                 "2:15: expected a node, found ']'"}},
        BadCase{"UnknownUse",
                "DEF WHEEL Group { } USE WEEL",
                {"2:25: USE of 'WEEL', which no DEF before it names, did you mean 'WHEEL'?"}},
        BadCase{"UseOfItself",
                "DEF A Group { children [ USE A ] }",
                {"2:30: USE of 'A' inside that node itself: a node cannot contain itself"}},
        BadCase{"UseOfALostNode", "DEF A Shpae { } USE A", {"2:7: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{
            "UseOfANodeInALostNode", "Switch { choice [ DEF A Group { } ] } USE A", {"2:1: Switch is not read yet"}},
        BadCase{"KeywordAsName", "DEF USE Group { }", {"2:5: expected a name after DEF, found 'USE'"}},
        BadCase{"Script",
                "DEF S Script { eventIn SFBool a url \"javascript: function a() { }\" }",
                {"2:7: Script is not read yet"}},
        BadCase{"Inline",
                "Group { children [ Inline { url \"a.wrl\" } Shap { } ] }",
                {"2:20: Inline is not read yet", "2:43: unknown node type 'Shap', did you mean 'Shape'?"}},
        BadCase{"Proto",
                "PROTO Car [ field SFVec3f at 0 0 0 ] { Group { } }\nDEF C Car { }\nUSE C",
                {"2:1: PROTO is not read yet: 'Car'", "3:7: 'Car' is an instance of a PROTO, which is not read yet"}},
        BadCase{"ExternProto",
                "EXTERNPROTO A [ ] \"a.wrl\" EXTERNPROTO B [ ] [ \"b.wrl\" \"c.wrl\" ] Group { }",
                {"2:1: EXTERNPROTO is not read yet: 'A'", "2:27: EXTERNPROTO is not read yet: 'B'"}},
        BadCase{"Route",
                "Group { } ROUTE A.x TO B.set_x Group { ROUTE A.x TO B.y }",
                {"2:11: ROUTE is not read yet: 'A.x TO B.set_x'", "2:40: ROUTE is not read yet: 'A.x TO B.y'"}},
        BadCase{"Is", "Group { children IS kids }", {"2:18: IS belongs inside a PROTO"}},
        BadCase{"Gibberish", "lorem ipsum dolor sit Grup { }\nGroup { }", {"2:1: expected a node, found 'lorem'"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(ParserLimits, RefuseDeepNestingInTheText) {
  const auto nested = [](std::uint32_t depth) {
    std::string body;
    for (std::uint32_t i = 0; i < depth; ++i) body += "Group{children[";
    for (std::uint32_t i = 0; i < depth; ++i) body += "]}";
    return body;
  };
  EXPECT_THAT(problems_of(nested(kMaxNesting)), IsEmpty());
  EXPECT_THAT(problems_of(nested(kMaxNesting + 1)), ElementsAre(HasSubstr("nested more than 256 deep")));
  EXPECT_THAT(problems_of(nested(200000)), ElementsAre(HasSubstr("nested more than 256 deep")));
}

TEST(ParserLimits, TakeAnyHeapOfBrackets) {
  for (const char* unit : {"[", "{", "Group{children", "Group{children[", "Script{", "USE ", "DEF ", "PROTO ", "ROUTE ",
                           "Group{", "Group{x ", "Coordinate{point[", "\"", "EXTERNPROTO a["}) {
    std::string body;
    for (int i = 0; i < 20000; ++i) body += unit;
    EXPECT_FALSE(problems_of(body).empty()) << unit;
  }
}

}  // namespace
}  // namespace peerd::vrml
