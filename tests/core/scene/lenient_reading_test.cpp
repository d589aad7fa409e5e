// These tests read worlds that depart from VRML97 (ISO/IEC 14772-1:1997) where browsers read on.
#include <gmock/gmock.h>

#include <algorithm>

#include "core/scene/reader.hpp"
#include "core/writer/scene_difference.hpp"
#include "core/writer/writer.hpp"

namespace peerd::lenient_reading_test {

using testing::AllOf;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

ReadResult read(std::string_view text, bool lenient) {
  ReadOptions options;
  options.name = "w.wrl";
  options.lenient = lenient;
  return read_world(text, options);
}

std::string written(const Scene& scene) {
  const auto world = write_world(scene);
  EXPECT_TRUE(world) << world.error();
  return world ? world->text : std::string();
}

std::string warnings_of(const ReadResult& result) {
  std::string all;
  for (const Diagnostic& d : result.diagnostics) all += render(result, d);
  return all;
}

struct Case {
  const char* name;
  const char* text;        // without a header
  const char* warning;     // says what is understood
  const char* understood;  // stands in the text that is written
};
void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

class LenientReading : public testing::TestWithParam<Case> {
 protected:
  const std::string text = std::string("#VRML V2.0 utf8\n") + GetParam().text;
};

TEST_P(LenientReading, IsRefusedStrictlyAndAllErrorsAreFaults) {
  const ReadResult result = read(text, false);
  EXPECT_FALSE(result.scene);
  EXPECT_THAT(result.diagnostics, Not(testing::IsEmpty()));
  EXPECT_THAT(result.diagnostics, testing::Contains(Field(&Diagnostic::is_fault, true)));
  for (const Diagnostic& d : result.diagnostics) {
    EXPECT_TRUE(d.is_fault || d.severity == Severity::kWarning) << d.message;
  }
}

TEST_P(LenientReading, IsAWarningAtItsPlaceThatSaysWhatIsUnderstood) {
  const ReadResult result = read(text, true);
  ASSERT_TRUE(result.scene) << warnings_of(result);
  EXPECT_GT(result.faults, 0u);
  EXPECT_THAT(result.diagnostics, Each(Field(&Diagnostic::severity, Severity::kWarning)));
  EXPECT_THAT(warnings_of(result), HasSubstr(GetParam().warning));
}

TEST_P(LenientReading, IsWrittenInStrictVrmlWithTheSameMeaning) {
  const ReadResult result = read(text, true);
  ASSERT_TRUE(result.scene);
  const std::string strict = written(*result.scene);
  EXPECT_THAT(strict, HasSubstr(GetParam().understood));
  const ReadResult again = read(strict, false);
  ASSERT_TRUE(again.scene) << strict << warnings_of(again);
  EXPECT_EQ(difference(*result.scene, *again.scene), "");
  EXPECT_EQ(written(*again.scene), strict);
}

INSTANTIATE_TEST_SUITE_P(
    Table, LenientReading,
    testing::Values(
        Case{"NumbersWithoutBlanks", "Transform { translation 1-2-3 children Shape { } }", "it is read as '1'",
             "translation 1 -2 -3"},
        Case{"TwoPeriods", "Transform { translation 1.5.25 2 }", "it is read as '1.5'", "translation 1.5 0.25 2"},
        Case{"LettersBehindANumber", "Transform { translation 1m 2 3 }", "it is read as '1'", "translation 1 2 3"},
        Case{"NotANumber", "Transform { translation nan 1.#QNAN 3 }", "it is read as '0'", "translation 0 1 3"},
        Case{"TooLarge", "Transform { translation 1e99 2 3 }", "it is read as '0'", "translation 0 2 3"},
        Case{"WholeNumberWithAPeriod",
             "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1.0 2 "
             "4294967295 ] } }",
             "it is read as '1.0'", "coordIndex [ 0 1 2 -1 ]"},
        Case{"NumbersLeftOver",
             "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 7 ] } coordIndex [ 0 1 2 "
             "] } }",
             "the incomplete element at its end is left out", "point [ 0 0 0, 1 0 0, 0 1 0 ]"},
        Case{"TooFewNumbers", "Transform { translation 1 2 scale 3 3 3 }", "the field has its default value",
             "scale 3 3 3"},
        Case{"BracketsAroundOneValue", "Transform { translation [ 1 2 3 ] scale 3 3 3 }", "they are passed over",
             "translation 1 2 3"},
        Case{"LowerCaseTruth", "Shape { geometry Cone { side false bottom TRUE } }", "it is read as FALSE",
             "side FALSE"},
        Case{"StringsWithoutQuotes", "Shape { geometry Text { string [ \"a\" b ] } }", "the element is left out",
             "string [ \"a\" ]"},
        Case{"OutOfRange", "Shape { geometry Sphere { radius -2 } }", "the field has its default value",
             "geometry Sphere"},
        Case{"UnknownField", "Transform { translatoin 1 2 3 scale 2 2 2 }", "the field is left out", "scale 2 2 2"},
        Case{"UnknownFieldOfAProto", "PROTO P [ ] { Transform { scale 2 2 2 } } P { rotation 0 1 0 1 }",
             "the field is left out", "scale 2 2 2"},
        Case{"UnknownNode", "Group { children [ Gropu { } Transform { scale 2 2 2 } ] }", "the node is left out",
             "scale 2 2 2"},
        Case{"NodeInTheWrongField", "Shape { appearance Material { } geometry Box { } }", "the node is left out there",
             "geometry Box"},
        Case{"UseOfNothing", "Group { children [ USE A Transform { scale 2 2 2 } ] }", "the node is left out",
             "scale 2 2 2"},
        Case{"ReservedName", "DEF field Transform { scale 2 2 2 } Group { children USE field }",
             "it is read as '_field'", "DEF _field Transform"},
        Case{"NameWithADigitFirst", "DEF 3Box Transform { scale 2 2 2 } Group { children USE 3Box }",
             "it is read as '_3Box'", "USE _3Box"},
        Case{"RouteOfTwoTypes",
             "DEF T TimeSensor { loop TRUE } DEF M Transform { } ROUTE T.fraction_changed TO M.set_translation",
             "the ROUTE is left out", "DEF M Transform"},
        Case{"RouteOfAnUnknownEvent", "DEF T TimeSensor { } DEF M Transform { } ROUTE T.isActive TO M.set_on",
             "the ROUTE is left out", "DEF M Transform"},
        Case{"RouteToNobody", "DEF T TimeSensor { } Transform { scale 2 2 2 } ROUTE T.isActive TO NONE.enabled",
             "the ROUTE is left out", "scale 2 2 2"},
        Case{"RouteOfAReservedName",
             "DEF TO TimeSensor { } DEF I PositionInterpolator { } ROUTE TO.fraction_changed TO I.set_fraction",
             "it is read as '_TO'", "ROUTE _TO.fraction_changed TO I.set_fraction"},
        Case{"ValueOfAnEvent", "Group { set_children [ Shape { } ] children Transform { scale 2 2 2 } }",
             "the value is left out", "scale 2 2 2"},
        Case{"IsOfNothing", "PROTO P [ ] { Transform { translation IS t scale 2 2 2 } } P { }", "the IS is left out",
             "scale 2 2 2"},
        Case{"ExposedFieldOfAScript", "DEF S Script { exposedField SFFloat x 1 } Transform { }",
             "it is read as a field", "field SFFloat x 1"},
        Case{"ValueOfAScript", "DEF S Script { field SFVec3f v \"\" } Transform { }", "is left out",
             "field SFVec3f v 0 0 0"},
        Case{"FieldOfAScriptThatIsAnEvent",
             "PROTO P [ eventIn SFFloat u ] { Group { children Script { field SFFloat v IS u } } } P { }",
             "the IS is left out", "field SFFloat v 0"},
        Case{"TwoFieldsOfAScript", "DEF S Script { field SFFloat x 1 field SFFloat x 2 } Transform { }",
             "the first one counts", "field SFFloat x 1"},
        Case{"TwoFieldsOfAProto",
             "PROTO P [ field SFVec3f s 2 2 2 field SFVec3f s 3 3 3 ] { Transform { scale IS s } } P { }",
             "the first one counts", "scale 2 2 2"},
        Case{"DefaultOutOfRange", "PROTO P [ field SFFloat r -1 ] { Shape { geometry Sphere { radius IS r } } } P { }",
             "the field has its default value", "geometry Sphere"},
        Case{"ProtoOfAStandardName", "PROTO Sphere [ ] { Box { size 3 3 3 } } Shape { geometry Sphere { } }",
             "the PROTO counts from here on", "size 3 3 3"},
        Case{"BraceTooMany", "Transform { scale 2 2 2 } } Group { }", "it is left out", "scale 2 2 2"},
        Case{"BracketMissing", "Group { children [ Shape { } } Transform { scale 2 2 2 }", "the list ends here",
             "scale 2 2 2"},
        Case{"MarkOfAnotherFile", "Transform { scale 2 2 2 }\n\xEF\xBB\xBF#VRML V2.0 utf8\nGroup { }",
             "the node is left out", "scale 2 2 2"},
        Case{"ControlByte", "Transform { \x01 scale 2 2 2 }", "it is left out", "scale 2 2 2"},
        Case{"IndexOutOfRange",
             "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 9 "
             "-1 7 1 2 ] } }",
             "the corner before it in its polygon is taken", "coordIndex [ 0 1 2 2 -1, 1 1 2 ]"},
        Case{"FewScales", "Shape { geometry Extrusion { spine [ 0 0 0 0 1 0 0 2 0 ] scale [ 1 1 2 3 ] } }",
             "the last one serves those that have none", "scale [ 1 1, 2 3, 2 3 ]"},
        Case{"FewOrientations",
             "Shape { geometry Extrusion { spine [ 0 0 0 0 1 0 0 2 0 ] orientation [ 0 1 0 0 0 1 0 1 ] } }",
             "the last one serves those that have none", "orientation [ 0 1 0 0, 0 1 0 1, 0 1 0 1 ]"},
        Case{"FewHeights", "Shape { geometry ElevationGrid { xDimension 2 zDimension 2 height [ 1 2 3 ] } }",
             "those that are missing are 0", "height [ 1 2 3 0 ]"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(LenientReadingOfHeaders, TakesATextThatBeginsAsAWorldDoes) {
  for (const std::string_view text :
       {"Shape { geometry Box { } }", "# a robot\n\nDEF A Group { }", "\n#VRML V2.0 utf8\nGroup { }",
        "#VRML V2.0 UTF-8\nGroup { }", "PROTO P [ ] { Group { } } P { }", "\xEF\xBB\xBFGroup { }"}) {
    const ReadResult strict = read(text, false), result = read(text, true);
    EXPECT_FALSE(strict.scene) << text;
    EXPECT_TRUE(strict.diagnostics.at(0).is_fault) << text;
    ASSERT_TRUE(result.scene) << text << warnings_of(result);
    EXPECT_THAT(warnings_of(result), HasSubstr("the text is read as VRML97")) << text;
  }
}

TEST(LenientReadingOfHeaders, RefusesOtherLanguagesAndTexts) {
  for (const std::string_view text : {"#VRML V1.0 ascii\nSeparator { }", "#X3D V2.0 utf8\nGroup { }", "<html></html>",
                                      "", "Worlds that are read or shown wrongly", "{ }",
                                      "\x7f"
                                      "ELF"}) {
    const ReadResult result = read(text, true);
    EXPECT_FALSE(result.scene) << text;
  }
}

// A lenient reader guesses at nothing: this stays refused.
TEST(LenientReadingOfTheUnreadable, StaysAnError) {
  for (const std::string_view text :
       {"Transform { scale 2 2 2", "Group { children [ Shape { }", "WorldInfo { title \"x }",
        "nothing of this is a node", "0 Cube { }", "PROTO P [ ] { Group { }"}) {
    const ReadResult result = read("#VRML V2.0 utf8\n" + std::string(text), true);
    EXPECT_FALSE(result.scene) << text;
  }
}

// Browsers open it, and show nothing.
TEST(LenientReadingOfUnknownNodes, IsAWorldOfNothing) {
  const ReadResult result = read("#VRML V2.0 utf8\nFoo { bar [ 1 2 ] }", true);
  ASSERT_TRUE(result.scene) << warnings_of(result);
  EXPECT_TRUE(result.scene->instances.empty());
  EXPECT_TRUE(read(written(*result.scene), false).scene);
}

TEST(LenientReadingOfGoodWorlds, ChangesNothing) {
  constexpr std::string_view kGood = "#VRML V2.0 utf8\nDEF A Transform { translation 1 2 3 children Shape { } }";
  const ReadResult result = read(kGood, true);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.faults, 0u);
  EXPECT_THAT(result.diagnostics, testing::IsEmpty());
  EXPECT_EQ(difference(*read(kGood, false).scene, *result.scene), "");
}

}  // namespace peerd::lenient_reading_test
