// These tests are about Inline (ISO/IEC 14772-1:1997, 4.5 and 6.25).
#include <gmock/gmock.h>

#include "core/scene/scene_statistics.hpp"
#include "tests/core/read_text.hpp"

namespace peerd::vrml::inline_loader_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Inline, IsAGroupOfItsFilesNodes) {
  const Scene scene = scene_of("DEF A Inline { url \"part.wrl\" }",
                               {{"part.wrl", "DEF P Transform { children Shape { } } WorldInfo { } Shape { }"}});
  EXPECT_THAT(paths_of(scene), ElementsAre("A", "A/P", "A/P/0", "A/2"));
  EXPECT_EQ(scene.instances[0].kind, NodeKind::kInline);
  EXPECT_FALSE(scene.instances[0].inner_name);
  EXPECT_TRUE(scene.instances[1].inner_name);
  EXPECT_EQ(document_violation(*scene.document), "");
  EXPECT_THAT(scene.pending_inlines, IsEmpty());
}

TEST(Inline, WithoutAUrlDoesNothing) {
  EXPECT_THAT(problems_of("Inline { } Inline { url [ ] } Inline { url [ ] bboxSize 1 1 1 }"), IsEmpty());
}

TEST(Inline, IsRelativeToTheFileThatHasIt) {
  const Scene scene = scene_of("Inline { url \"a/one.wrl\" }",
                               {{"a/one.wrl", "Inline { url \"b/two.wrl\" } Inline { url \"../three.wrl\" }"},
                                {"a/b/two.wrl", "DEF TWO Shape { }"},
                                {"three.wrl", "DEF THREE Shape { }"}});
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/0/TWO", "0/1", "0/1/THREE"));
}

TEST(Inline, SharesAFileThatIsThereTwice) {
  const std::string body = "Inline { url \"a.wrl\" } Transform { children Inline { url \"./a.wrl\" } }";
  const Files files = {{"a.wrl", "DEF S Shape { geometry Box { } }"}};
  const Scene scene = scene_of(body, files);
  ASSERT_THAT(paths_of(scene), ElementsAre("0", "0/S", "1", "1/0", "1/0/S"));
  EXPECT_EQ(scene.instances[1].node, scene.instances[4].node);
  EXPECT_EQ(scene.geometries.size(), 1u);
  EXPECT_EQ(read_body(body, files).sources.size(), 2u);
}

// The URLs stand in decreasing order of preference (4.5.2).
TEST(Inline, TriesItsUrlsInOrder) {
  std::vector<std::string> asked;
  ReadOptions options;
  options.load = loader_of({{"b.wrl", "Shape { }"}, {"c.wrl", "Group { } Group { }"}}, &asked);
  const Scene scene = scene_of(R"(Inline { url [ "a.wrl" "b.wrl" "c.wrl" ] })", {}, options);
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0"));
  EXPECT_THAT(asked, ElementsAre("a.wrl", "b.wrl"));
}

TEST(Inline, StaysEmptyWhereThereIsNoFile) {
  const std::string body = "Group { children Inline { url [ \"a.wrl\" \"b.wrl\" ] } }";
  EXPECT_THAT(problems_of(body),
              ElementsAre("warning 2:31: this Inline stays empty: 'a.wrl': no such file; 'b.wrl': no such file"));
  EXPECT_THAT(paths_of(scene_of(body)), ElementsAre("0", "0/0"));
}

TEST(Inline, GivesNoNamesToTheWorldNorTakesAny) {  // 4.6.2: names are those of one file
  EXPECT_THAT(errors_of("Inline { url \"a.wrl\" }\nUSE IN", {{"a.wrl", "DEF IN Group { }"}}),
              ElementsAre("3:5: USE of 'IN', which no DEF before it names"));
  EXPECT_THAT(errors_of("DEF OUT Group { }\nInline { url \"a.wrl\" }", {{"a.wrl", "USE OUT"}}),
              ElementsAre("a.wrl:2:5: USE of 'OUT', which no DEF before it names"));
  EXPECT_THAT(errors_of("PROTO P [ ] { Group { } }\nInline { url \"a.wrl\" }", {{"a.wrl", "P { }"}}),
              ElementsAre("a.wrl:2:1: unknown node type 'P'"));
  EXPECT_THAT(errors_of("Inline { url \"a.wrl\" }\nPp { }", {{"a.wrl", "PROTO Pp [ ] { Group { } }"}}),
              ElementsAre("3:1: unknown node type 'Pp'"));
}

TEST(Inline, FindsTheWorldsNamesFirst) {
  const Scene scene =
      scene_of("Inline { url \"a.wrl\" } DEF A Group { }", {{"a.wrl", "DEF A Shape { } DEF B Shape { }"}});
  EXPECT_EQ(scene.find("A"), ObjectId{3});
  EXPECT_EQ(scene.find("B"), ObjectId{2});
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
    EXPECT_EQ(scene.find(scene.path_of(ObjectId{i})), ObjectId{i});
}

TEST(Inline, BringsItsRoutesScriptsAndInterests) {
  const Scene scene = scene_of("Inline { url \"a.wrl\" } DEF HIT Shape { } DEF WALL Shape { }",
                               {{"a.wrl",
                                 "DEF T TouchSensor { } DEF C TimeSensor { } ROUTE T.touchTime TO C.startTime\n"
                                 "DEF ME Transform { } DEF HIT Shape { } CollisionInterest { objectPath \"ME\" "
                                 "interests [ \"HIT\" \"WALL\" ] }"}});
  EXPECT_THAT(routes_of(*scene.document), ElementsAre("T.touchTime > C.startTime"));
  ASSERT_EQ(scene.interests.size(), 1u);
  EXPECT_EQ(scene.path_of(scene.interests[0].colliders.ends.front()), "0/ME");
  EXPECT_THAT(scene.interests[0].collidees.ends, ElementsAre(scene.find("0/HIT"), scene.find("WALL")));
}

TEST(InlineInAProto, TakesItsUrlFromTheInstance) {
  const Files files = {{"a.wrl", "DEF A Shape { }"}, {"b.wrl", "DEF B Shape { }"}, {"c.wrl", "DEF C Shape { }"}};
  const Scene scene = scene_of(R"(
    PROTO Part [ field MFString file "a.wrl" ] { Group { children [ Inline { url IS file } Inline { url "c.wrl" } ] } }
    Part { } Part { file "b.wrl" } Part { file [ "none.wrl" "b.wrl" ] })",
                               files);
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/0/A", "0/1", "0/1/C",  //
                                           "1", "1/0", "1/0/B", "1/1", "1/1/C",  //
                                           "2", "2/0", "2/0/B", "2/1", "2/1/C"));
  EXPECT_EQ(document_violation(*scene.document), "");
}

TEST(InlineInAProto, TakesItsUrlThroughTwoLevels) {
  const Scene scene = scene_of(R"(
    PROTO In [ exposedField MFString u "none.wrl" ] { Inline { url IS u } }
    PROTO Out [ field MFString file "a.wrl" ] { Transform { children In { u IS file } } }
    Out { } Out { file "b.wrl" })",
                               {{"a.wrl", "DEF A Shape { }"}, {"b.wrl", "DEF B Shape { }"}});
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/0", "0/0/A", "1", "1/0", "1/0/B"));
}

TEST(InlineInAProto, IsNotReadWithoutAnInstance) {
  EXPECT_THAT(problems_of("PROTO P [ ] { Inline { url \"none.wrl\" } }"), IsEmpty());
}

TEST(InlineInAProto, SaysOnceThatAFileIsMissing) {
  EXPECT_THAT(problems_of("PROTO P [ ] { Inline { url \"none.wrl\" } }\nP { }").size(), 1u);
}
TEST(InlineInAProto, SaysOnceThatItContainsItself) {
  EXPECT_THAT(errors_of("PROTO P [ ] { Inline { url \"world.wrl\" } }\nP { }").size(), 1u);
}

TEST(InlineInAProto, OfAnotherFileIsRelativeToTheFileThatHasTheUrl) {
  const Scene scene = scene_of("EXTERNPROTO P [ field MFString u ] \"lib/p.wrl\" P { } P { u \"mine.wrl\" }",
                               {{"lib/p.wrl", "PROTO P [ field MFString u \"own.wrl\" ] { Inline { url IS u } }"},
                                {"lib/own.wrl", "DEF OWN Shape { }"},
                                {"mine.wrl", "DEF MINE Shape { }"}});
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/OWN", "1", "1/MINE"));
}

TEST(InlineCycles, AreRefused) {
  EXPECT_THAT(errors_of("Group { }\nInline { url \"world.wrl\" }"),
              ElementsAre("3:14: 'world.wrl': that file is being read already: it contains itself"));
  EXPECT_THAT(errors_of("Inline { url \"a.wrl\" }", {{"a.wrl", "Inline { url \"a.wrl\" }"}}),
              ElementsAre("a.wrl:2:14: 'a.wrl': that file is being read already: it contains itself"));
  EXPECT_THAT(errors_of("Inline { url \"x/a.wrl\" }", {{"x/a.wrl", "Inline { url \"../b.wrl\" }"},
                                                       {"b.wrl", "Group { }\nInline { url \"x/a.wrl\" }"}}),
              ElementsAre("b.wrl:3:14: 'x/a.wrl': that file is being read already: it contains itself"));
  EXPECT_THAT(errors_of("Inline { url \"a.wrl\" }", {{"a.wrl", "EXTERNPROTO P [ ] \"p.wrl\" P { }"},
                                                     {"p.wrl", "PROTO P [ ] { Inline { url \"a.wrl\" } }"}})
                  .size(),
              1u);
}

TEST(InlineDepth, HasALimitInFiles) {
  Files files;
  for (int i = 0; i < 100; ++i) files["f" + std::to_string(i)] = "Inline { url \"f" + std::to_string(i + 1) + "\" }";
  EXPECT_THAT(errors_of("Inline { url \"f0\" }", files), ElementsAre(HasSubstr("files are nested more than 32 deep")));
}

TEST(InlineDepth, CountsNodesThroughFiles) {
  const auto nested = [](int depth, const std::string& inner) {
    std::string body;
    for (int i = 0; i < depth; ++i) body += "Group{children[";
    body += inner;
    for (int i = 0; i < depth; ++i) body += "]}";
    return body;
  };
  const auto world = [&](int depth) {
    return errors_of(nested(depth, "Inline{url\"a.wrl\"}"),
                     {{"a.wrl", nested(100, "Inline{url\"b.wrl\"}")}, {"b.wrl", nested(100, "Shape{}")}});
  };
  EXPECT_THAT(world(50), IsEmpty());
  EXPECT_THAT(world(60), ElementsAre(HasSubstr("nested more than 256 deep")));
}

TEST(InlineErrors, StandInTheirOwnFile) {
  const Files files = {{"sub/a.wrl", "Group { }\n\tDEF \xC3\xA4 Shpae { }"}, {"b.wrl", "Grop { }"}};
  const std::string body = "Inline { url \"b.wrl\" }\nInline { url \"sub/a.wrl\" } Inline { url \"b.wrl\" } Shpae { }";
  const ReadResult result = read_body(body, files);
  EXPECT_THAT(lines_of(result), ElementsAre("3:51: unknown node type 'Shpae', did you mean 'Shape'?",
                                            "b.wrl:2:1: unknown node type 'Grop', did you mean 'Group'?",
                                            "sub/a.wrl:3:9: unknown node type 'Shpae', did you mean 'Shape'?"));
  EXPECT_EQ(
      render(result, result.diagnostics.back()),
      "sub/a.wrl:3:9: error: unknown node type 'Shpae', did you mean 'Shape'?\n\tDEF \xC3\xA4 Shpae { }\n\t      ^\n");
  EXPECT_EQ(result.sources[0].name, "world.wrl");
}

TEST(InlineErrors, OfAnIndexAreInTheFileThatHasIt) {
  EXPECT_THAT(
      errors_of("Inline { url \"a.wrl\" }",
                {{"a.wrl",
                  "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 ] }\ncoordIndex [ 0 0 7 ] } }"}}),
      ElementsAre(HasSubstr("a.wrl:3:18: coordIndex 7 is out of range")));
}

TEST(InlineErrors, OfAFileThatIsNoVrml) {
  EXPECT_THAT(
      problems_of("Inline { url \"a.wrl\" }", {{"a.wrl", "#VRML V1.0 ascii\nSeparator { }"}}),
      ElementsAre("warning 2:14: this Inline stays empty: 'a.wrl': this is VRML 1.0, another language; only VRML97 "
                  "('#VRML V2.0 utf8') is read"));
}

TEST(InlineErrors, OfAFileThatIsNoVrmlLeaveTheNextUrl) {  // 4.5.2
  const std::string body = "Inline { url [ \"a.wrl\" \"b.wrl\" ] }";
  const Files files = {{"a.wrl", "#X3D V2.0 utf8\n"}, {"b.wrl", "Shape { }"}};
  EXPECT_THAT(problems_of(body, files), IsEmpty());
  EXPECT_THAT(paths_of(scene_of(body, files)), ElementsAre("0", "0/0"));
}

TEST(InlineErrors, WarnOfWhatIsNoChild) {  // 6.25: undefined
  EXPECT_THAT(problems_of("Inline { url \"a.wrl\" }", {{"a.wrl", "Box { }"}}),
              ElementsAre("warning a.wrl:2:1: Box at the top level is not part of the scene by itself"));
}

class InlinesLater : public testing::Test {
 protected:
  InlinesLater() { options.defer_inlines = true; }
  ReadOptions options;
  const Files files{{"a.wrl", "DEF A Shape { }"}, {"bad.wrl", "Shpae { }"}};
};

TEST_F(InlinesLater, LeaveOutWhatSaysHowLargeItIs) {
  const Scene scene = scene_of(
      "Inline { url \"bad.wrl\" bboxSize 1 2 3 bboxCenter 4 5 6 } Inline { url \"a.wrl\" } Inline { url \"a.wrl\" "
      "bboxSize -1 -1 -1 }",
      files, options);
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "1", "1/A", "2", "2/A"));
  ASSERT_EQ(scene.pending_inlines.size(), 1u);
  EXPECT_EQ(scene.pending_inlines[0].instance, ObjectId{0});
  EXPECT_EQ(scene.pending_inlines[0].box_size, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(scene.pending_inlines[0].box_center, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(statistics_of(scene).pending_inlines, 1u);
}
TEST_F(InlinesLater, ReadNothingOfThemInAProtoEither) {
  EXPECT_THAT(problems_of("PROTO P [ ] { Inline { url \"bad.wrl\" bboxSize 1 1 1 } } P { }", files, options),
              IsEmpty());
}
TEST_F(InlinesLater, TakeTheSizeFromAProtosInstance) {
  const std::string body =
      "PROTO P [ field SFVec3f s -1 -1 -1 ] { Inline { url \"a.wrl\" bboxSize IS s } } P { } P { s 1 1 1 }";
  const Scene scene = scene_of(body, files, options);
  EXPECT_THAT(paths_of(scene), ElementsAre("0", "0/A", "1"));
  EXPECT_EQ(scene.pending_inlines.size(), 1u);
}
TEST_F(InlinesLater, AreNotPendingWithoutAUrl) {  // 6.25: an Inline with an empty URL does nothing
  EXPECT_THAT(scene_of("Inline { url [ ] bboxSize 1 1 1 }", files, options).pending_inlines, IsEmpty());
}
TEST(InlinesNow, AreNeverPending) {
  EXPECT_THAT(scene_of("Inline { url \"none.wrl\" bboxSize 1 1 1 }").pending_inlines, IsEmpty());
  EXPECT_THAT(scene_of("Inline { url \"a.wrl\" bboxSize 1 1 1 }", {{"a.wrl", ""}}).pending_inlines, IsEmpty());
}

}  // namespace peerd::vrml::inline_loader_test
