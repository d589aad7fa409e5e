#include "core/parser/parser.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::parser_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::shared_ptr<const Document> document_of(const std::string& body) { return scene_of(body).document; }

TEST(Parser, ReadsEveryFieldType) {
  const auto document = document_of(R"(
    Transform { enslaved TRUE rotation 0 1 0 .5 translation 1,2,3 }
    Extrusion { crossSection [ 1 2, 3 4 ] orientation [ 0 0 1 2 ] }
    Text { string [ "a" "b\"c" ] length 1.5 maxExtent 2 }
    IndexedLineSet { coordIndex [ 0 1 2 -1, 0x10 ] }
    PixelTexture { image 2 1 3 0xFF0000 255 }
    Shape { splitThreshold 7 hierarchyFile "a.hier" }
    Group { children [ Shape { } Group { children Shape { } } ] }
    TimeSensor { startTime 1234567890.123456789 }
    Material { diffuseColor 0.1 0.2 0.3 }
    Background { skyColor [ 1 0 0, 0 1 0 ] groundAngle 1 }
    TextureTransform { scale 2 3 }
    Shape { geometry Box { } })");
  const auto value = [&](std::size_t top, std::string_view field) -> const Field& {
    return *document->nodes[document->top_level[top].index].find(field);
  };
  EXPECT_TRUE(value(0, "enslaved").as<bool>()[0]);
  EXPECT_THAT(value(0, "rotation").as<float>(), ElementsAre(0, 1, 0, 0.5f));
  EXPECT_THAT(value(0, "translation").as<float>(), ElementsAre(1, 2, 3));
  EXPECT_THAT(value(1, "crossSection").as<float>(), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(value(1, "orientation").as<float>(), ElementsAre(0, 0, 1, 2));
  EXPECT_THAT(value(2, "string").as<std::string_view>(), ElementsAre("a", "b\"c"));
  EXPECT_THAT(value(2, "length").as<float>(), ElementsAre(1.5f));
  EXPECT_THAT(value(3, "coordIndex").as<std::int32_t>(), ElementsAre(0, 1, 2, -1, 16));
  EXPECT_THAT(value(4, "image").as<std::int32_t>(), ElementsAre(2, 1, 3, 0xFF0000, 255));
  EXPECT_THAT(value(5, "splitThreshold").as<std::int32_t>(), ElementsAre(7));
  EXPECT_THAT(value(5, "hierarchyFile").as<std::string_view>(), ElementsAre("a.hier"));
  EXPECT_EQ(value(6, "children").as<NodeRef>().size(), 2u);
  EXPECT_THAT(value(7, "startTime").as<double>(), ElementsAre(1234567890.123456789));
  EXPECT_THAT(value(8, "diffuseColor").as<float>(), ElementsAre(0.1f, 0.2f, 0.3f));
  EXPECT_THAT(value(9, "skyColor").as<float>(), ElementsAre(1, 0, 0, 0, 1, 0));
  EXPECT_THAT(value(9, "groundAngle").as<float>(), ElementsAre(1));
  EXPECT_THAT(value(10, "scale").as<float>(), ElementsAre(2, 3));
  EXPECT_TRUE(value(11, "geometry").as<NodeRef>()[0].is_node());
}

TEST(Parser, PutsNodesBehindAllThatTheyReferTo) {
  const auto document = document_of("DEF A Group { children [ DEF B Shape { } Group { children USE B } ] } USE A");
  EXPECT_EQ(document_violation(*document), "");
  EXPECT_EQ(document->top_level[0].index, document->top_level[1].index);
}

TEST(Parser, LetsALaterDefTakeOverAName) {
  const auto document = document_of("DEF A Group { children DEF A Shape { } } USE A");
  EXPECT_EQ(document->nodes[document->top_level[1].index].type->name, "Shape");
}

TEST(Parser, KeepsValuesAndNamesWithoutTheText) {
  std::shared_ptr<const Document> document;
  {
    std::string text =
        world_text("DEF NAME WorldInfo { title \"some title\" info [ \"plain\" \"with \\\" escape\" ] }");
    document = read_world(text).scene.value().document;
    std::ranges::fill(text, '?');
  }
  EXPECT_EQ(document->nodes.at(0).def, "NAME");
  EXPECT_EQ(document->nodes[0].find("title")->as<std::string_view>()[0], "some title");
  EXPECT_EQ(document->nodes[0].find("info")->as<std::string_view>()[1], "with \" escape");
}

TEST(Parser, AcceptsWhatTheStandardAllows) {
  EXPECT_THAT(problems_of(""), IsEmpty());
  EXPECT_THAT(problems_of("Group { children NULL } Shape { geometry NULL }"), IsEmpty());
  EXPECT_THAT(problems_of("Group { children [ ] } Group{children[Shape{},Shape{},]}"), IsEmpty());
  EXPECT_THAT(problems_of("Transform { rotation 0 0 0 0 }"), IsEmpty());
  EXPECT_THAT(problems_of("DEF a+b-c:d Group{}USE a+b-c:d#end"), IsEmpty());
  EXPECT_THAT(problems_of("PixelTexture { image 0 0 0 }").size(), 1u) << "it stands at the top level";
}

// DEF names may be words of the language that are no keywords, and types too.
TEST(Parser, TakesTypesAndFieldsForNames) {
  EXPECT_THAT(errors_of("DEF Group Group { children DEF children Shape { } } USE Group USE children"), IsEmpty());
}

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
        BadCase{"GeometryAmongChildren",
                "Group { children Box { } }",
                {"warning 2:18: 'children' takes a child of a group; Box is a geometry node: write Shape { geometry "
                 "Box { .. } }; here it has no effect"}},
        BadCase{"MaterialAmongChildren",
                "Group { children [ Material { } ] }",
                {"warning 2:20: 'children' takes a child of a group; Material is a Material; here it has no effect"}},
        BadCase{
            "GeometryAtTheTop", "Box { }", {"warning 2:1: Box at the top level is not part of the scene by itself"}},
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
                 "warning 2:51: 'size' should be > 0, found '0'; it is taken as it is"}},
        BadCase{"LowerCaseTrue",
                "Transform { enslaved true remote 1 }",
                {"2:22: 'enslaved' (SFBool) wants TRUE or FALSE, found 'true'",
                 "2:34: 'remote' (SFBool) wants TRUE or FALSE, found '1'"}},
        BadCase{"ZeroAxis",
                "Transform { rotation 0 0 0 1 }",
                {"warning 2:22: 'rotation' has an axis of length 0 and an angle that is not 0; nothing is turned"}},
        BadCase{"MissingQuote",
                "WorldInfo { title \"a\nGroup { }",
                {"2:11: this WorldInfo is never closed: a '}' is missing",
                 "2:19: this string is never closed: a '\"' is missing"}},
        BadCase{"MissingBracket",
                "Group { children [ Shape { } }\nShpae { }",
                {"2:30: expected ']', found '}'", "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"MissingBracketBeforeField",
                "Coordinate { point [ 0 0 0 point [ 1 1 1 ] }",
                {"warning 2:1: Coordinate at the top level is not part of the scene by itself",
                 "2:28: expected ']', found 'point'"}},
        BadCase{"MissingBracketBeforeFieldWithANode",
                "Shape { geometry Box { } }\nTransform { children [ Shape { } scale 1 1 1 }",
                {"3:34: expected ']', found 'scale'"}},
        BadCase{"MissingBraceInList",
                "Group { children [ Transform { translation 1 2 3 ] } Box",
                {"2:50: expected a field of Transform or its '}', found ']'",
                 "2:57: expected '{' after Box, found the end of the file"}},
        BadCase{"StrayBrackets",
                "} Group { ] } ]",
                {"2:1: expected a node, found '}'", "2:11: expected a field of Group or its '}', found ']'",
                 "2:15: expected a node, found ']'"}},
        BadCase{"UseOfANodeInALostNode",
                "Swich { choice [ DEF A Group { } ] } USE A",
                {"2:1: unknown node type 'Swich', did you mean 'Switch'?"}},
        BadCase{"KeywordAsName", "DEF USE Group { }", {"2:5: expected a name after DEF, found 'USE'"}},
        BadCase{"Gibberish", "lorem ipsum dolor sit Grup { }\nGroup { }", {"2:1: expected a node, found 'lorem'"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// Several independent mistakes are found in one pass, each once (4.3 gives the language no end of ways).
TEST(Recovery, FindsAllMistakesOnce) {
  EXPECT_THAT(
      problems_of("Transform { translaton 1 2 3 children [\n"
                  " Shpae { }\n"
                  " Shape { geometry Box { size 1 2 } }\n"
                  " USE NOBODY\n"
                  " Transform { rotation 0 0 1 }\n"
                  " Group { children 5 }\n"
                  "] scale 1 1 x }\n"
                  "ROUTE A.b TO C.d\n"
                  "PROTO P [ field SFVec4f a 1 ] { Group { } }\n"
                  "P { } Q { }"),
      ElementsAre(HasSubstr("2:13: Transform has no field 'translaton'"), HasSubstr("3:2: unknown node type 'Shpae'"),
                  HasSubstr("4:34: 'size' (SFVec3f) wants 3 numbers, found '}'"), HasSubstr("5:6: USE of 'NOBODY'"),
                  HasSubstr("6:29: 'rotation' (SFRotation) wants 4 numbers, found '}'"),
                  HasSubstr("7:19: 'children' (MFNode) wants a node"),
                  HasSubstr("8:13: 'scale' (SFVec3f) wants 3 numbers, found 'x'"), HasSubstr("8:13:"),
                  HasSubstr("9:7: ROUTE names 'A'"), HasSubstr("9:14: ROUTE names 'C'"),
                  HasSubstr("10:17: expected a field type, found 'SFVec4f'"),
                  HasSubstr("11:7: unknown node type 'Q'")));
}

// Additions of a browser's own to nodes that only show something are let pass; a slip of the pen is not.
TEST(UnknownFields, OfDisplayNodesAreWarnings) {
  EXPECT_THAT(problems_of("Shape { appearance Appearance { material Material { fogImmune TRUE gloss 0.5 0.5\n "
                          "diffuseColor 1 0 0 } } }"),
              ElementsAre("warning 2:53: Material has no field 'fogImmune' in VRML97; it is passed over",
                          "warning 2:68: Material has no field 'gloss' in VRML97; it is passed over"));
  EXPECT_THAT(
      problems_of(
          "Viewpoint { extra Thing { a [ { } ] } list [ A { } B { } ] nodes DEF N Thing { } description \"d\" }")
          .size(),
      3u);
  EXPECT_THAT(errors_of("Viewpoint { extra Thing { } } Shpae { }").size(), 1u);
  EXPECT_THAT(problems_of("Material { difuseColor 1 0 0 }").at(1),
              HasSubstr("2:12: Material has no field 'difuseColor', did you mean 'diffuseColor'?"));
  EXPECT_THAT(errors_of("Transform { extra 1 }"), ElementsAre("2:13: Transform has no field 'extra'"));
}

// A name that was DEFed inside of a part that was passed over is lost, and its USE reports nothing more.
TEST(UnknownFields, LoseTheNamesInThem) {
  EXPECT_THAT(errors_of("Viewpoint { extra DEF N Thing { part DEF M Thing { } } } USE N USE M"), IsEmpty());
}

}  // namespace peerd::vrml::parser_test
