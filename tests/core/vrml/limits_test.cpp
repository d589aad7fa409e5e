// These tests bound the cost of a text: ReadLimits, depth, the number of problems, and texts that are made to be slow.
// None of them looks at a clock; a quadratic reader runs into the time limit of the test.
#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::limits_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string times(int count, const std::string& unit) {
  std::string out;
  for (int i = 0; i < count; ++i) out += unit;
  return out;
}
// '%' becomes the number.
std::string numbered(int count, const std::string& unit) {
  std::string out;
  for (int i = 0; i < count; ++i) {
    for (const char c : unit) {
      if (c == '%') {
        out += std::to_string(i);
      } else {
        out += c;
      }
    }
  }
  return out;
}

// PROTO P0 is `inner`; each further one holds the one before it twice: 2^levels copies.
std::string doubling(int levels, const std::string& inner) {
  std::string body = "PROTO P0 [ ] { " + inner + " }\n";
  for (int i = 1; i <= levels; ++i) {
    const std::string below = "P" + std::to_string(i - 1) + " { } ";
    body += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + below + below + "] } }\n";
  }
  return body + "P" + std::to_string(levels) + " { }";
}

ReadOptions with_limits(ReadLimits limits) {
  ReadOptions options;
  options.limits = limits;
  return options;
}

// The world has thirty lines that name a billion instances.
TEST(InstanceLimit, RefusesExplodingUse) {
  std::string body = "DEF N0 Group { }\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string below = std::to_string(i - 1);
    body += "DEF N" + std::to_string(i) + " Group { children [ USE N" + below + " USE N" + below + " ] }\n";
  }
  EXPECT_THAT(problems_of(body), ElementsAre(HasSubstr("there are more than 4194304 instances")));
}

TEST(InstanceLimit, IsExact) {
  const std::string body = "DEF A Group { children [ Shape { } Shape { } ] } USE A USE A";
  EXPECT_THAT(problems_of(body, {}, with_limits({.instances = 9})), IsEmpty());
  EXPECT_THAT(problems_of(body, {}, with_limits({.instances = 8})),
              ElementsAre("2:56: with this node there are more than 8 instances"));
}

TEST(NodeLimit, IsExact) {
  const std::string body = "Group { children [ Shape { } Shape { geometry Box { } } ] }";
  EXPECT_THAT(problems_of(body, {}, with_limits({.nodes = 4})), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 3})),
              ElementsAre(HasSubstr("2:1: with this node there are more than 3 nodes")));
}

TEST(NodeLimit, RefusesExplodingProtos) {
  EXPECT_THAT(errors_of(doubling(40, "Group { }")), ElementsAre(HasSubstr("more than 4194304 nodes, PROTOs expanded")));
  EXPECT_THAT(errors_of(doubling(12, "Group { }"), {}, with_limits({.nodes = 1000})),
              ElementsAre(HasSubstr("more than 1000 nodes")));
}

TEST(NodeLimit, CountsOtherFiles) {
  const Files files = {{"a.wrl", times(100, "Shape { } ")}};
  EXPECT_THAT(problems_of("Inline { url \"a.wrl\" } Inline { url \"a.wrl\" }", files, with_limits({.nodes = 110})),
              IsEmpty());
  EXPECT_THAT(errors_of("Inline { url \"a.wrl\" }", files, with_limits({.nodes = 90})),
              ElementsAre(HasSubstr("a.wrl:2:")));
}

// Nodes are not all that a PROTO's copies are made of: one node of many children, ROUTEs, links.
TEST(MemoryLimit, CountsReferences) {
  const std::string body = doubling(10, "Group { children [ DEF S WorldInfo { } " + times(2000, "USE S ") + "] }");
  const ReadResult result = read_body(body, {}, with_limits({.nodes = 100'000}));
  if (result.scene) {
    EXPECT_LT(result.scene->document->arena.size_bytes(), 1u << 20) << "for " << body.size() << " bytes of text";
  }
}
TEST(MemoryLimit, CountsReferencesOfDefaults) {
  const std::string body = "PROTO P [ field MFNode kids [ DEF S WorldInfo { } " + times(2000, "USE S ") +
                           "] ] { Group { children [ " + times(2000, "Group { children IS kids } ") + "] } } P { }";
  const ReadResult result = read_body(body, {}, with_limits({.nodes = 100'000}));
  if (result.scene) {
    EXPECT_LT(result.scene->document->arena.size_bytes(), 4u << 20) << "for " << body.size() << " bytes of text";
  }
}
TEST(MemoryLimit, CountsRoutes) {
  const std::string body =
      "PROTO A [ eventOut SFBool o ] { Group { children [ " + times(600, "TouchSensor { isOver IS o } ") + "] } }\n" +
      "PROTO B [ eventIn SFBool i ] { Group { children [ " + times(600, "TimeSensor { enabled IS i } ") + "] } }\n" +
      "DEF A A { } DEF B B { } " + times(10, "ROUTE A.o TO B.i ");
  const ReadResult result = read_body(body, {}, with_limits({.nodes = 10'000}));
  if (result.scene) {
    EXPECT_LE(result.scene->document->routes.size(), 360'000u) << "for " << body.size() << " bytes of text";
  }
}
TEST(MemoryLimit, CountsRoutesOfCopies) {
  const std::string body = doubling(10, "DEF T TimeSensor { } " + times(1000, "ROUTE T.isActive TO T.loop "));
  const ReadResult result = read_body(body, {}, with_limits({.nodes = 10'000}));
  if (result.scene) {
    EXPECT_LE(result.scene->document->routes.size(), 10'000u) << "for " << body.size() << " bytes of text";
  }
}

// The limit also counts ROUTEs, links, fields and lists that instances take as they are.
TEST(MemoryLimit, CountsLinksOfCopies) {
  const std::string body =
      "PROTO P [ field SFFloat r 1 ] { Sphere { " + times(3000, "radius IS r ") + "} } " + times(50, "P { } ");
  EXPECT_THAT(errors_of(body), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 10'000})), ElementsAre(HasSubstr("more than 10000 nodes")));
}
TEST(MemoryLimit, CountsFieldsOfCopies) {
  const std::string body = "PROTO P [ ] { Group { children Script { field SFNode n NULL " +
                           numbered(3000, "field SFBool f% TRUE ") + "} } } " + times(50, "P { } ");
  EXPECT_THAT(errors_of(body), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 10'000})), ElementsAre(HasSubstr("more than 10000 nodes")));
}
TEST(MemoryLimit, CountsDefaultsOfCopies) {
  const std::string body = "PROTO P [ field MFNode kids [ DEF S WorldInfo { } " + times(3000, "USE S ") +
                           "] ] { Group { children IS kids } } " + times(50, "P { } ");
  EXPECT_THAT(errors_of(body), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 10'000})), ElementsAre(HasSubstr("more than 10000 nodes")));
}
TEST(MemoryLimit, CountsListsThatManyLinksTake) {
  const std::string body =
      "PROTO P [ field MFNode k [ ] ] { Group { children [ " + times(300, "Group { children IS k } ") +
      "] } }\nPROTO R [ ] { P { k [ DEF S WorldInfo { } " + times(300, "USE S ") + "] } }\n" + times(50, "R { } ");
  EXPECT_THAT(errors_of(body), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 200'000})), ElementsAre(HasSubstr("more than 200000 nodes")));
}
// Nodes of as many fields as most have cost no more than a node.
TEST(MemoryLimit, CountsNoLinksOfSmallNodes) {
  const std::string body = "PROTO P [ field SFFloat r 1 ] { Sphere { radius IS r } } " + times(8, "P { } ");
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 9})), IsEmpty());
  EXPECT_THAT(errors_of(body, {}, with_limits({.nodes = 8})), ElementsAre(HasSubstr("more than 8 nodes")));
}

TEST(TextLimit, IsOfAllTextsTogether) {
  const std::string body = "Inline { url \"a.wrl\" }";
  const Files files = {{"a.wrl", "Shape { }"}};
  const std::uint64_t all = world_text(body).size() + world_text("Shape { }").size();
  EXPECT_THAT(problems_of(body, files, with_limits({.text_bytes = all})), IsEmpty());
  EXPECT_THAT(problems_of(body, files, with_limits({.text_bytes = all - 1})),
              ElementsAre(HasSubstr("2:14: this Inline stays empty: 'a.wrl': it is larger than")));
  EXPECT_THAT(errors_of(body, files, with_limits({.text_bytes = 10})),
              ElementsAre(HasSubstr("1:1: it is larger than 10 bytes")));
}

TEST(Depth, IsLimitedInTheText) {
  const auto nested = [](int depth) { return times(depth, "Group{children[") + times(depth, "]}"); };
  EXPECT_THAT(problems_of(nested(kMaxNesting)), IsEmpty());
  EXPECT_THAT(problems_of(nested(kMaxNesting + 1)), ElementsAre(HasSubstr("nested more than 256 deep")));
  EXPECT_THAT(problems_of(nested(200'000)), ElementsAre(HasSubstr("nested more than 256 deep")));
}

TEST(Depth, IsLimitedInChainsOfUse) {
  const auto chain = [](int length) {
    std::string body = "DEF N0 Group { }\n";
    for (int i = 1; i < length; ++i) {
      body += "DEF N" + std::to_string(i) + " Group { children USE N" + std::to_string(i - 1) + " }\n";
    }
    return body;
  };
  EXPECT_THAT(problems_of(chain(256)), IsEmpty());
  EXPECT_THAT(problems_of(chain(1000)), ElementsAre(HasSubstr("nested more than 256 deep")));
}

TEST(Depth, IsLimitedInChainsOfProtos) {
  std::string body = "PROTO P0 [ ] { Group { } }\n";
  for (int i = 1; i < 300; ++i) {
    body += "PROTO P" + std::to_string(i) + " [ ] { Group { children P" + std::to_string(i - 1) + " { } } }\n";
  }
  EXPECT_THAT(errors_of(body + "P200 { }"), IsEmpty());
  EXPECT_THAT(errors_of(body + "P299 { }"), ElementsAre(HasSubstr("nested more than 256 deep")));
}

TEST(ErrorLimit, StopsTheReader) {
  for (const char* unit :
       {"Grop {}\n", "Group { x 1 }\n", "USE A\n", "ROUTE A.b TO C.d\n", "PROTO P [ x ] { Group { } }\n", "\x01 \n",
        "CollisionInterest { objectPath \"A\" interests \"B\" }\n",
        "Shape { geometry IndexedFaceSet { coord Coordinate { point 0 0 0 } coordIndex [ 1 2 3 ] } }\n"}) {
    const auto problems = errors_of(times(5000, unit));
    EXPECT_EQ(problems.size(), Problems::kLimit) << unit;
    EXPECT_TRUE(problems.back().ends_with("the reader stops here, after 1000 errors")) << problems.back();
  }
}

TEST(ErrorLimit, IsOfAllFilesTogether) {
  EXPECT_EQ(errors_of("Inline { url \"a\" }\n" + times(700, "Grop {}\n"), {{"a", times(700, "Grop {}\n")}}).size(),
            Problems::kLimit);
}

TEST(WarningLimit, HidesTheRestAndReadsOn) {
  const auto problems = problems_of(times(5000, "Transform { scale 0 0 0 }\n"));
  ASSERT_EQ(problems.size(), Problems::kLimit);
  EXPECT_TRUE(problems.back().ends_with("further warnings are not shown")) << problems.back();
  EXPECT_EQ(errors_of(times(5000, "Transform { scale 0 0 0 }\n") + "Grop {}").size(), 1u);
}

class AnyHeap : public testing::TestWithParam<const char*> {};
TEST_P(AnyHeap, Ends) { EXPECT_FALSE(problems_of(times(200'000, GetParam())).empty()); }
INSTANTIATE_TEST_SUITE_P(OfPieces, AnyHeap,
                         testing::Values("[", "{", "]", "Group{children", "Group{children[", "Script{",
                                         "Script{field SFNode a ", "USE ", "DEF ", "DEF A ", "PROTO ", "PROTO P[",
                                         "PROTO P[]{", "PROTO P[field SFNode a ", "ROUTE ", "ROUTE A.", "Group{",
                                         "Group{x ", "Group{x[", "Coordinate{point[", "\"", "\"\\", "EXTERNPROTO a[",
                                         "EXTERNPROTO a[]", "IS ", "Material{x ", "Material{x DEF ", "0 ",
                                         "PixelTexture{image 9999 9999 1 ", "Shape{geometry ", ". "));

class LargeText : public testing::TestWithParam<std::pair<const char*, std::string (*)()>> {};
TEST_P(LargeText, IsReadInLinearTime) {
  const std::string body = GetParam().second();
  EXPECT_GT(body.size(), 400'000u);
  EXPECT_LT(body.size(), 6'000'000u);
  EXPECT_LE(read_body(body).diagnostics.size(), 2 * Problems::kLimit);
}
INSTANTIATE_TEST_SUITE_P(
    Table, LargeText,
    testing::Values(
        std::pair{"Siblings", +[] { return numbered(100'000, "DEF A% Transform { }\n"); }},
        std::pair{"EqualNames", +[] { return times(150'000, "DEF A Group { } USE A\n"); }},
        std::pair{"Protos", +[] { return numbered(60'000, "PROTO P% [ ] { Group { } } P% { }\n"); }},
        std::pair{
            "WrongNodesAmongManyProtos",
            +[] { return numbered(60'000, "PROTO Thing% [ ] { Group { } }\n") + numbered(1000, "Thung% { }\n"); }},
        std::pair{"WrongNamesAmongMany",
                  +[] { return numbered(100'000, "DEF Thing% Group { }\n") + numbered(1000, "USE Thung%\n"); }},
        std::pair{"InterfaceOfManyFields",
                  +[] {
                    return "PROTO P [" + numbered(60'000, " field SFBool f% TRUE") + " ] { Group { } } P {" +
                           numbered(60'000, " f% FALSE") + "}";
                  }},
        std::pair{"ScriptOfManyFields", +[] { return "Script {" + numbered(60'000, " field SFBool f% TRUE") + "}"; }},
        std::pair{"ManyLinks",
                  +[] {
                    return "PROTO P [ field SFFloat r 1 ] { Group { children [ " +
                           times(20'000, "Shape { geometry Sphere { radius IS r } } ") + "] } } P { } P { }";
                  }},
        std::pair{"LinksOfOneField",
                  +[] {
                    return "PROTO A [ field SFFloat r 1 ] { Shape { geometry Sphere { " + times(2'000, "radius IS r ") +
                           "} } }\nPROTO B [ field SFFloat r 1 ] { A { " + times(2'000, "r IS r ") + "} } " +
                           std::string(400'000, ' ');
                  }},
        std::pair{"DefaultsThatUse",
                  +[] {
                    return numbered(30'000, "DEF A% Group { }\n") +
                           times(30'000, "PROTO P [ field SFNode n USE A29999 ] { Group { } }\n");
                  }},
        std::pair{"InstancesWithInterests",
                  +[] {
                    return "PROTO Car [ ] { DEF ME Transform { children CollisionInterest { objectPath \"ME\" "
                           "interests \"WALL\" } } }\nDEF WALL Group { }\n" +
                           times(60'000, "Car { }\n");
                  }},
        std::pair{"DefinedInstancesWithInterests",
                  +[] {
                    return "PROTO Car [ ] { DEF ME Transform { children CollisionInterest { objectPath \"ME\" "
                           "interests \"WALL\" } } }\nDEF WALL Group { }\n" +
                           numbered(60'000, "DEF C% Car { }\n");
                  }},
        std::pair{"Interests",
                  +[] {
                    return numbered(30'000,
                                    "DEF A% Group { } CollisionInterest { objectPath \"A%\" interests \"A0\" }\n");
                  }},
        std::pair{"InterestsByPath",
                  +[] {
                    return "DEF Z Group { }\n" + numbered(30'000,
                                                          "DEF A% Group { children Shape { } } CollisionInterest { "
                                                          "objectPath \"A%/0\" interests \"Z\" }\n");
                  }},
        std::pair{"InterestsByNumber",
                  +[] {
                    return "DEF Z Group { } DEF A Group { children [ " + times(150'000, "Shape{}") +
                           "] } CollisionInterest { objectPath \"Z\" interests [ " + numbered(150'000, "\"A/%\" ") +
                           "] }";
                  }},
        std::pair{"InstancesWithInterestsAndNoNames",
                  +[] {
                    return "PROTO C [ ] { Group { children CollisionInterest { objectPath \"A\" interests \"B\" } } }\n"
                           "DEF A Group { } DEF B Group { } " +
                           times(80'000, "C { }\n");
                  }},
        std::pair{"InterestsInWhatIsLost",
                  +[] {
                    return "DEF Z Group { } Grop { " + numbered(100'000, "DEF L% Group { } ") +
                           "} CollisionInterest { objectPath \"Z\" interests [ " + numbered(100'000, "\"L%\" ") + "] }";
                  }},
        std::pair{"WrongInterestsAmongManyInstances",
                  +[] {
                    return "DEF Thing Group { } " + times(200'000, "USE Thing ") +
                           numbered(1'000, "CollisionInterest { objectPath \"Thung%\" interests \"Thing\" }\n");
                  }},
        std::pair{"InterestsInNothing",
                  +[] {
                    return numbered(4'000, "DEF Wheel% Group { }\n") +
                           numbered(30'000, "CollisionInterest { objectPath \"Whele%\" interests \"B%\" }\n");
                  }},
        std::pair{"RoutesInOneProto",
                  +[] {
                    return "PROTO P [ eventIn SFBool i ] { Group { children [ " +
                           times(5'000, "TimeSensor { enabled IS i } ") + "] } }\nDEF S TouchSensor { } DEF A P { } " +
                           numbered(5'000, "ROUTE S.isOver TO A.enabled%\n") + std::string(200'000, ' ');
                  }},
        std::pair{"InlinesInOneProto",
                  +[] {
                    return "PROTO P [ field MFString u \"none\" ] { Group { children [ " +
                           times(20'000, "Inline { url IS u } ") + "] } } P { }";
                  }},
        std::pair{"InlinesBesideLinks",
                  +[] {
                    return "PROTO P [ field SFFloat r 1 ] { Group { children [ Shape { geometry Sphere { " +
                           times(150'000, "radius IS r ") + "} } " + times(150'000, "Inline{}") + "] } } P { }";
                  }},
        std::pair{"InstancesOfManyLinks",
                  +[] {
                    return "PROTO P [ field SFFloat r 1 ] { Sphere { " + times(30'000, "radius IS r ") + "} }\n" +
                           times(30'000, "P { } ");
                  }},
        std::pair{"ListThatManyLinksTake",
                  +[] {
                    return "PROTO P [ field MFNode k [ ] ] { Group { children [ " +
                           times(60'000, "Group { children IS k } ") + "] } } P { k [ DEF S WorldInfo { } " +
                           times(60'000, "USE S ") + "] }";
                  }},
        std::pair{"NumbersThatManyLinksTake",
                  +[] {
                    return "PROTO P [ field MFFloat r [ ] ] { Group { children [ " +
                           times(60'000, "LOD { range IS r } ") + "] } } P { r [ " + times(300'000, "1 ") + "] }";
                  }},
        std::pair{
            "LinksOfOneEvent",
            +[] { return "PROTO P [ eventIn SFBool e ] { TimeSensor { " + times(250'000, "enabled IS e ") + "} }"; }},
        std::pair{"LinksOfOneEventBeforeValues",
                  +[] {
                    return "PROTO P [ eventIn SFBool e field SFBool l TRUE ] { TimeSensor { " +
                           times(150'000, "enabled IS e ") + times(150'000, "loop IS l ") + "} }";
                  }},
        std::pair{"LinksOfAnotherField",
                  +[] {
                    return "PROTO A [ field SFFloat r 1 field SFFloat s 1 ] { Sphere { " +
                           times(150'000, "radius IS s ") + "} }\nPROTO B [ field SFFloat r 1 ] { A { " +
                           times(150'000, "r IS r ") + "} } ";
                  }},
        std::pair{"LinksOfManyFieldsOfANode",
                  +[] {
                    const std::string fields = numbered(1'000, "field SFBool f% TRUE ");
                    return "PROTO P [ " + fields + "] { Group { children Script { " +
                           numbered(1'000, "field SFBool g% IS f% ") + "} } }\n" + times(70'000, "P { } ");
                  }},
        std::pair{"RoutesFromNoLinksToMany",
                  +[] {
                    return "PROTO Q [ eventOut SFBool o ] { Group { } } PROTO P [ eventIn SFBool i ] { TimeSensor { " +
                           times(150'000, "enabled IS i ") + "} }\nDEF Q Q { } DEF P P { } " +
                           times(150'000, "ROUTE Q.o TO P.i ");
                  }},
        std::pair{"ScriptsThatAreToldOfWhatIsAround",
                  +[] {
                    return "DEF A Group { children [ " + times(120'000, "Script{field SFNode a USE A}") +
                           times(150'000, "DEF B Group{}") + "] }";
                  }},
        std::pair{"Rotations",
                  +[] { return "OrientationInterpolator { keyValue [ " + times(100'000, "0 0 0 1 ") + "] }"; }},
        std::pair{"WrongIndices",
                  +[] {
                    return "Shape { geometry IndexedFaceSet { coord Coordinate { point 0 0 0 } coordIndex [ " +
                           times(500'000, "7 8 9 -1 ") + "] } }";
                  }},
        std::pair{"WrongRanges", +[] { return "LOD { range [ " + times(500'000, "-1 ") + "] }"; }},
        std::pair{"OneLongLine",
                  +[] { return times(3'000, "Grop { x } ") + std::string(3'000'000, ' ') + "Grop { }"; }},
        std::pair{
            "OneLongName",
            +[] { return "DEF " + std::string(2'000'000, 'x') + " Group { } USE " + std::string(2'000'000, 'x'); }},
        std::pair{"Comments", +[] { return times(100'000, "#\n#a ]\n Group { # }\n }\n"); }},
        std::pair{"BracketsInComments",
                  +[] { return "Coordinate { point [ " + times(100'000, "1 2 3 # ]\n") + "] }"; }},
        std::pair{"ListsOfOne", +[] { return "LOD { level [ " + times(60'000, "LOD { range [ 1 ] } ") + "] }"; }},
        std::pair{"OpenLists", +[] { return times(60'000, "LOD { range [ 1 "); }}),
    [](const auto& text) { return std::string(text.param.first); });

// An interest names a range of instances, and an Inline that was left empty stands in some of the ranges or in none.
TEST(ManyInterests, BesideManyInlinesLeftEmpty) {
  const std::string body =
      "PROTO C [ ] { Group { children CollisionInterest { objectPath \"A\" interests \"B\" } } }\n"
      "DEF A Group { } DEF B Group { } DEF I Inline { url \"a\" bboxSize 1 1 1 } " +
      times(100'000, "USE I ") + times(80'000, "C{}");
  ReadOptions options;
  options.defer_inlines = true;
  const ReadResult result = read_body(body, {{"a", "Shape { }"}}, options);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.scene->pending_inlines.size(), 100'001u);
}

}  // namespace peerd::vrml::limits_test
