// These tests are about EXTERNPROTO (ISO/IEC 14772-1:1997, 4.3.7, 4.5.2 and 4.9).
#include <gmock/gmock.h>

#include "core/parser/parser.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::vrml::type_finder_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Numbers = std::vector<float>;

const Files kLibrary = {
    {"lib/parts.wrl",
     "Group { }\n"
     "EXTERNPROTO Far [ field SFFloat r ] \"more.wrl#Ball\"\n"
     "PROTO Box1 [ field SFVec3f s 1 1 1 ] { Shape { geometry Box { size IS s } } }\n"
     "PROTO Ball [ exposedField SFVec3f at 0 0 0 field SFFloat r 2 ] {\n"
     "  Transform { translation IS at children Shape { geometry Sphere { radius IS r } } } }"},
    {"lib/more.wrl", "PROTO Ball [ field SFFloat r 5 ] { Shape { geometry Sphere { radius IS r } } }"},
};

TEST(ExternProto, TakesTheFirstProtoOfAFileWhateverItsName) {  // 4.9.3
  const Scene scene =
      scene_of("EXTERNPROTO Cube [ field SFVec3f s ] \"lib/parts.wrl\" Cube { s 1 2 3 } Cube { }", kLibrary);
  EXPECT_THAT(floats_of(*scene.document, "Box", "size"), ElementsAre(Numbers{1, 2, 3}, Numbers{1, 1, 1}));
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(ExternProto, TakesTheNamedProto) {  // 4.9.3
  const Scene scene = scene_of(
      "EXTERNPROTO B [ field SFFloat r exposedField SFVec3f at ] \"lib/parts.wrl#Ball\" DEF X B { r 9 at 1 0 0 }",
      kLibrary);
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"), ElementsAre(Numbers{9}));
  EXPECT_THAT(paths_of(scene), ElementsAre("X", "X/0"));
}

TEST(ExternProto, FollowsChainsRelativeToEachFile) {
  const Scene scene = scene_of("EXTERNPROTO B [ field SFFloat r ] \"lib/parts.wrl#Far\" B { } B { r 3 }", kLibrary);
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"), ElementsAre(Numbers{5}, Numbers{3}));
}

// The URLs stand in decreasing order of preference (4.5.2).
TEST(ExternProto, TriesItsUrlsInOrder) {
  std::vector<std::string> asked;
  ReadOptions options;
  options.load = loader_of(
      {{"b.wrl", "Group { }"}, {"c.wrl", "PROTO P [ ] { Shape { } }"}, {"d.wrl", "PROTO P [ ] { Group { } }"}}, &asked);
  const Scene scene =
      scene_of(R"(EXTERNPROTO P [ ] [ "a.wrl" "b.wrl" "c.wrl#Q" "c.wrl#P" "d.wrl" ] P { })", {}, options);
  EXPECT_EQ(scene.instances.at(0).kind, NodeKind::kShape);
  EXPECT_THAT(asked, ElementsAre("a.wrl", "b.wrl", "c.wrl", "c.wrl"));
}

TEST(ExternProto, IsNotLookedForUntilItIsUsed) {
  std::vector<std::string> asked;
  ReadOptions options;
  options.load = loader_of({}, &asked);
  EXPECT_THAT(problems_of("EXTERNPROTO P [ ] \"none.wrl\" EXTERNPROTO Q [ ] [ ] Group { }", {}, options), IsEmpty());
  EXPECT_THAT(asked, IsEmpty());
}

// 4.9.4: if no URL is found, it is an empty node. It keeps the fields that the world gives it.
TEST(ExternProto, NotFoundIsAnEmptyNode) {
  const std::string body =
      "EXTERNPROTO Torus [ field SFFloat r eventIn SFFloat set_r eventOut SFFloat r_changed ] [ \"none.wrl\" "
      "\"urn:x:Torus\" ]\n"
      "Shape { geometry DEF T Torus { r 2 } } Group { children [ Torus { } Shape { } ] }\n"
      "ROUTE T.r_changed TO T.set_r";
  EXPECT_THAT(problems_of(body),
              ElementsAre("warning 2:13: EXTERNPROTO 'Torus' is not found, its instances stay empty: "
                          "'none.wrl': no such file; 'urn:x:Torus': no such file"));
  const Scene scene = scene_of(body);
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "1", "1/1"));
}

// The types of a document's nodes live as long as it does.
TEST(ExternProto, NotFoundKeepsItsTypeInTheDocument) {
  const std::string text =
      world_text("EXTERNPROTO Torus [ field SFFloat r ] \"none.wrl\" Shape { geometry Torus { r 2 } }");
  Problems problems;
  const auto document = parse({"w", text, nullptr}, problems, {.load = loader_of({}), .limits = {}});
  EXPECT_EQ(document_violation(*document), "");
}

TEST(ExternProto, WithoutALoaderIsNotFound) {
  EXPECT_THAT(
      lines_of(read_world("#VRML V2.0 utf8\nEXTERNPROTO P [ ] \"p.wrl\" P { }")),
      ElementsAre(
          "warning 2:13: EXTERNPROTO 'P' is not found, its instances stay empty: 'p.wrl': no other file is read here"));
}

class BadExternProto : public testing::TestWithParam<BadCase> {};
TEST_P(BadExternProto, IsReportedWhereItIs) { EXPECT_EQ(problems_of(GetParam().body, kLibrary), GetParam().problems); }
INSTANTIATE_TEST_SUITE_P(
    Table, BadExternProto,
    testing::Values(
        // Names and types must be a subset of those of the implementation (4.9.2). The mistake is reported once, and
        // nothing false besides.
        BadCase{"UnknownField",
                "EXTERNPROTO B [ field SFFloat radius ] \"lib/more.wrl\"\nB { }",
                {"2:13: this declaration does not fit: Ball has no field 'radius'"}},
        BadCase{"OtherType",
                "EXTERNPROTO B [ field SFInt32 r ] \"lib/more.wrl\"\nB { } B { }",
                {"2:13: this declaration does not fit: Ball has 'r' as SFFloat, not SFInt32"}},
        BadCase{"OtherAccess",
                "EXTERNPROTO B [ eventIn SFFloat r ] \"lib/more.wrl\"\nB { }",
                {"2:13: this declaration does not fit: Ball has 'r' as field, not eventIn"}},
        BadCase{"NoName",
                "EXTERNPROTO [ ] \"lib/more.wrl\"\nGroup { }",
                {"2:13: expected a name after EXTERNPROTO, found '['"}},
        BadCase{"NoInterface",
                "EXTERNPROTO B \"lib/more.wrl\"\nGroup { }",
                {"2:15: expected '[' and the interface of 'B', found the string \"lib/more.wrl'"}},
        BadCase{"NoUrl",
                "EXTERNPROTO B [ ]\nGroup { }",
                {"3:1: 'the URL of an EXTERNPROTO' (MFString) wants a string in quotes, found 'Group'"}},
        BadCase{"DefaultValue",
                "EXTERNPROTO B [ field SFFloat r 1 ] \"lib/more.wrl\"\nShpae { }",
                {"2:33: expected eventIn, eventOut, field, exposedField or ']' in the interface of 'B', found '1'",
                 "3:1: unknown node type 'Shpae', did you mean 'Shape'?"}},
        BadCase{"StandardName",
                "EXTERNPROTO Box [ ] \"lib/more.wrl\"",
                {"2:13: 'Box' is a node of the standard: no PROTO can take its name"}},
        BadCase{"NoProtoOfThatName",
                "EXTERNPROTO B [ ] \"lib/more.wrl#Bell\"\nB { }",
                {"warning 2:13: EXTERNPROTO 'B' is not found, its instances stay empty: 'lib/more.wrl#Bell': it has no "
                 "PROTO of that name"}},
        BadCase{"WorldItself",
                "EXTERNPROTO B [ ] \"world.wrl\"\nB { }",
                {"2:13: 'world.wrl': that file is being read already: it contains itself",
                 "warning 2:13: EXTERNPROTO 'B' is not found, its instances stay empty: 'world.wrl': that file is "
                 "being read "
                 "already: it contains itself"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// 4.8.2: an exposedField x is a field x, an eventIn set_x and an eventOut x_changed; each may be declared by itself.
TEST(ExternProtoInterface, MayNameTheEventsOfAnExposedField) {
  EXPECT_THAT(
      problems_of("EXTERNPROTO B [ eventIn SFVec3f set_at eventOut SFVec3f at_changed ] \"lib/parts.wrl#Ball\"\n"
                  "DEF A B { } DEF C B { }\nROUTE A.at_changed TO C.set_at",
                  kLibrary),
      IsEmpty());
}
TEST(ExternProtoInterface, MayNameTheFieldOfAnExposedField) {
  EXPECT_THAT(problems_of("EXTERNPROTO B [ field SFVec3f at ] \"lib/parts.wrl#Ball\" B { at 1 2 3 }", kLibrary),
              IsEmpty());
}

TEST(ExternProtoErrors, StandInTheirOwnFile) {
  const std::string body = "Group { }\nEXTERNPROTO P [ ] \"lib/bad.wrl\"\nP { } P { }";
  const Files files = {{"lib/bad.wrl", "PROTO P [ ] {\r\n  Shpae { }\r\n}"}};
  EXPECT_THAT(problems_of(body, files),
              ElementsAre("lib/bad.wrl:3:3: unknown node type 'Shpae', did you mean 'Shape'?"));
  const ReadResult result = read_body(body, files);
  EXPECT_EQ(render(result, result.diagnostics.at(0)),
            "lib/bad.wrl:3:3: error: unknown node type 'Shpae', did you mean 'Shape'?\n  Shpae { }\n  ^\n");
}

TEST(ExternProtoErrors, OfAFileThatIsNoVrml) {
  EXPECT_THAT(
      problems_of("EXTERNPROTO P [ ] \"bad.wrl\"\nP { }", {{"bad.wrl", "#X3D V2.0 utf8\n"}}),
      ElementsAre("warning 2:13: EXTERNPROTO 'P' is not found, its instances stay empty: 'bad.wrl': this "
                  "header is none of X3D, which has '#X3D V3.0 utf8' up to '#X3D V4.0 utf8' as its first line"));
}

// Names of a library are its own; what its nodes would add to the world stays out of it.
TEST(ExternProtoScope, KeepsTheLibrarysSceneOut) {
  const Scene scene = scene_of("EXTERNPROTO B [ ] \"lib/parts.wrl#Box1\" B { }", kLibrary);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_TRUE(nodes_of_type(*scene.document, "Group").empty());
  EXPECT_THAT(errors_of("EXTERNPROTO B [ ] \"lib/parts.wrl#Box1\"\nBall { }", kLibrary),
              ElementsAre(HasSubstr("3:1: unknown node type 'Ball'")));
}

TEST(ExternProtoScope, ReadsAFileOnceForAllItsProtos) {
  const ReadResult result = read_body(
      "EXTERNPROTO A [ ] \"lib/parts.wrl#Box1\" EXTERNPROTO B [ ] \"./lib/../lib/parts.wrl#Ball\" A { } B { }",
      kLibrary);
  EXPECT_EQ(result.sources.size(), 2u);
  EXPECT_EQ(result.diagnostics.size(), 0u);
}

TEST(ExternProtoScope, UsedInAPrototypeAndThroughAnInline) {
  const Scene scene = scene_of(
      "EXTERNPROTO Ball [ field SFFloat r ] \"lib/more.wrl\"\n"
      "PROTO Two [ field SFFloat r 1 ] { Group { children [ Ball { r IS r } Ball { } ] } } Two { r 8 }\n"
      "Inline { url \"lib/user.wrl\" }",
      {{"lib/more.wrl", kLibrary.at("lib/more.wrl")},
       {"lib/user.wrl", "EXTERNPROTO Ball [ field SFFloat r ] \"more.wrl\" Ball { r 7 }"}});
  EXPECT_THAT(floats_of(*scene.document, "Sphere", "radius"), ElementsAre(Numbers{8}, Numbers{5}, Numbers{7}));
  EXPECT_EQ(document_violation(*scene.document), "");
}

// These tests run in processes of their own: a fault here overflows the stack.
void read_and_leave(const std::string& body, const Files& files) {
  const ReadResult result = read_body(body, files);
  std::_Exit(result.diagnostics.empty() || result.sources.size() > 40 ? 1 : 0);
}
TEST(ExternProtoCycles, OfNothingButDeclarationsEnd) {
  EXPECT_EXIT(read_and_leave("EXTERNPROTO X [ ] \"a.wrl#X\" X { }",
                             {{"a.wrl", "EXTERNPROTO X [ ] \"b.wrl#X\""}, {"b.wrl", "EXTERNPROTO X [ ] \"a.wrl#X\""}}),
              testing::ExitedWithCode(0), "");
  EXPECT_EXIT(read_and_leave("EXTERNPROTO X [ ] \"a.wrl#X\" X { }", {{"a.wrl", "EXTERNPROTO X [ ] \"a.wrl#X\""}}),
              testing::ExitedWithCode(0), "");
}
TEST(ExternProtoCycles, OfFilesThatUseEachOtherEnd) {
  EXPECT_EXIT(read_and_leave("EXTERNPROTO X [ ] \"a.wrl#X\" X { }",
                             {{"a.wrl", "EXTERNPROTO Y [ ] \"b.wrl#Y\" PROTO X [ ] { Group { children Y { } } }"},
                              {"b.wrl", "EXTERNPROTO X [ ] \"a.wrl#X\" PROTO Y [ ] { Group { children X { } } }"}}),
              testing::ExitedWithCode(0), "");
}
TEST(ExternProtoCycles, LongChainsInOneFileEnd) {
  std::string chain;
  for (int i = 0; i < 20000; ++i) {
    chain += "EXTERNPROTO X" + std::to_string(i) + " [ ] \"a.wrl#X" + std::to_string(i + 1) + "\"\n";
  }
  chain += "PROTO X20000 [ ] { Group { } }";
  const auto read = [&] {
    static_cast<void>(read_body("EXTERNPROTO X [ ] \"a.wrl#X0\" X { }", {{"a.wrl", chain}}));
    std::_Exit(0);
  };
  EXPECT_EXIT(read(), testing::ExitedWithCode(0), "");
}
TEST(ExternProtoCycles, LongChainsOfFilesEnd) {
  Files files;
  for (int i = 0; i < 2000; ++i) {
    const std::string next = std::to_string(i + 1);
    files["x" + std::to_string(i) + ".wrl"] = "EXTERNPROTO X [ ] \"x" + next + ".wrl#X\" PROTO P [ ] { X { } }";
  }
  files["x2000.wrl"] = "PROTO X [ ] { Group { } }";
  EXPECT_THAT(errors_of("EXTERNPROTO P [ ] \"x0.wrl#P\" P { }", files),
              testing::Contains(HasSubstr("nested more than")));
}

// The worlds declare our own nodes so that other browsers load them too (4.9.4).
TEST(ExternProtoOfOurOwn, IsKnownByItsName) {
  const Scene scene = scene_of(R"(
    EXTERNPROTO KeySensor [ field SFInt32 keyValue field SFString recipient field SFVec3f value ] "keys.wrl"
    DEF A Transform { }
    KeySensor { keyValue 65 recipient "A" value 1 2 3 })");
  ASSERT_EQ(scene.key_sensors.size(), 1u);
  EXPECT_EQ(scene.key_sensors[0].key_value, 65);
}

TEST(ExternProtoOfOurOwn, IsKnownByItsUrn) {
  const Scene scene = scene_of(R"(
    EXTERNPROTO Watch [ field SFString objectPath field MFString interests ]
      [ "urn:peerd:node:CollisionInterest" "watch.wrl" ]
    DEF A Group { } DEF B Group { }
    Watch { objectPath "A" interests "B" })");
  EXPECT_EQ(scene.interests.size(), 1u);
}

TEST(ExternProtoOfOurOwn, MustFitToo) {
  EXPECT_THAT(
      errors_of("EXTERNPROTO Watch [ field SFString path ] \"urn:peerd:node:CollisionInterest\"\nWatch { }"),
      testing::Contains(HasSubstr("2:13: this declaration does not fit: CollisionInterest has no field 'path'")));
}

TEST(ExternProtoOfOurOwn, IsKnownByItsUrnInALibraryToo) {
  const Scene scene = scene_of(
      "EXTERNPROTO Watch [ field SFString objectPath field MFString interests ] \"lib/own.wrl#Watcher\"\n"
      "DEF A Group { } DEF B Group { } Watch { objectPath \"A\" interests \"B\" }",
      {{"lib/own.wrl",
        "EXTERNPROTO Watcher [ field SFString objectPath field MFString interests ] "
        "\"urn:peerd:node:CollisionInterest\""}});
  EXPECT_EQ(scene.interests.size(), 1u);
}

}  // namespace peerd::vrml::type_finder_test
