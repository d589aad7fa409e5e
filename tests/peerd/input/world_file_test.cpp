#include "peerd/input/world_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::world_file_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

struct UrlCase {
  const char *url, *path;  // "": no file of this machine
};
class LocalPath : public testing::TestWithParam<UrlCase> {};
TEST_P(LocalPath, IsTheFileThatTheUrlNames) {
  const auto path = local_path(GetParam().url);
  EXPECT_EQ(path.value_or("").string(), GetParam().path) << GetParam().url;
}
INSTANTIATE_TEST_SUITE_P(Table, LocalPath,
                         testing::Values(UrlCase{"a.wrl", "a.wrl"}, UrlCase{"b/a.wrl", "b/a.wrl"},
                                         UrlCase{"file:///x/a.wrl", "/x/a.wrl"},
                                         UrlCase{"file://localhost/x/a.wrl", "/x/a.wrl"},
                                         UrlCase{"file:a.wrl", "a.wrl"}, UrlCase{"a%20b.wrl", "a b.wrl"},
                                         UrlCase{"a%2", "a%2"}, UrlCase{"a%zz", "a%zz"}, UrlCase{"a%00b", "a%00b"},
                                         UrlCase{"http://h/a.wrl", ""}, UrlCase{"urn:x:y", ""},
                                         UrlCase{"javascript:x", ""}, UrlCase{"b/c:d", "b/c:d"}, UrlCase{"", ""}));

TEST(WorldFile, ReadsInlinesBesideItAndNamesThem) {
  const ScratchFolder folder;
  folder.write("inner.wrl", "#VRML V2.0 utf8\nDEF INNER Transform { }\n");
  const auto path = folder.write("w.wrl", "#VRML V2.0 utf8\nDEF IN Inline { url \"inner.wrl\" }\n");
  const auto file = must(read_world_file(path));
  ASSERT_TRUE(file->result.scene);
  ASSERT_EQ(file->result.sources.size(), 2u);
  EXPECT_EQ(file->result.sources[0].name, path.string());
  EXPECT_THAT(file->result.sources[1].name, testing::EndsWith("inner.wrl"));
}

TEST(WorldFile, AWorldThatIncludesItselfIsNoEndlessOne) {
  const ScratchFolder folder;
  const auto path = folder.write("w.wrl", "#VRML V2.0 utf8\nInline { url \"./w.wrl\" }\n");
  const auto file = must(read_world_file(path));
  ASSERT_FALSE(file->result.diagnostics.empty());
}

TEST(WorldFile, NoFileIsAnErrorAndOneWithErrorsIsAResult) {
  const ScratchFolder folder;
  EXPECT_THAT(error_of(read_world_file(folder / "none.wrl")).text, HasSubstr("none.wrl: error: there is no such file"));
  const auto wrong = must(read_world_file(folder.write("w.wrl", "#VRML V2.0 utf8\nTransform { translation 1 }\n")));
  EXPECT_FALSE(wrong->result.scene);
  EXPECT_FALSE(wrong->result.diagnostics.empty());
}

TEST(WorldFile, WhatTheWorldAsksForInVainIsAmongItsWarnings) {
  const ScratchFolder folder;
  const auto file =
      read_world_file(folder.write("w.wrl", "#VRML V2.0 utf8\nShape { splitThreshold 3 }\nTransform { x 1 }"));
  ASSERT_TRUE(file);
  EXPECT_EQ((*file)->result.diagnostics.size(), 1u) << "of a bad world the errors alone";
  const auto good = must(read_world_file(folder.write("w.wrl", "#VRML V2.0 utf8\nShape { splitThreshold 3 }\n")));
  ASSERT_EQ(good->result.diagnostics.size(), 1u);
  EXPECT_EQ(good->result.diagnostics[0].where.line, 2u);
  EXPECT_THAT(good->result.diagnostics[0].message, testing::StartsWith("splitThreshold does nothing"));
}

// A wall that another file has, without a header, and a ROUTE that browsers pass over.
class LenientWorld : public testing::Test {
 protected:
  LenientWorld() {
    folder.write("wall.wrl", "DEF WALL Transform { translation 1-2-3 children Shape { geometry Box { } } }\n");
    path = folder.write("w.wrl",
                        "#VRML V2.0 utf8\nDEF T TimeSensor { }\nDEF field Inline { url \"wall.wrl\" }\n"
                        "ROUTE T.cycleTime TO field.bboxSize\n");
  }
  ScratchFolder folder;
  std::filesystem::path path;
};

TEST_F(LenientWorld, IsAnErrorThatNamesTheOptionWithoutIt) {
  const auto file = must(read_world_file(path));
  EXPECT_FALSE(file->result.scene);
  EXPECT_THAT(lenient_advice(file->result), testing::StartsWith("note: --lenient"));
  EXPECT_EQ(lenient_advice(must(read_world_file(folder / "w.wrl", {.lenient = true}))->result), "");
}

TEST_F(LenientWorld, IsWhatWasUnderstoodInStrictVrml) {
  const auto file = must(read_world_file(path, {.lenient = true}));
  ASSERT_TRUE(file->result.scene);
  EXPECT_THAT(file->text, testing::StartsWith("#VRML V2.0 utf8\n"));
  EXPECT_THAT(file->text, HasSubstr("translation 1 -2 -3"));
  EXPECT_THAT(file->result.diagnostics, testing::IsEmpty());
  EXPECT_EQ(file->result.sources.size(), 1u);
}

TEST_F(LenientWorld, ReportsTheFaultsOfTheFilesThatPeopleWrote) {
  const auto file = must(read_world_file(path, {.lenient = true}));
  const ReadResult& reported = file->reported();
  ASSERT_EQ(reported.sources.size(), 2u);
  std::string all;
  for (const Diagnostic& d : reported.diagnostics) all += render(reported, d);
  EXPECT_THAT(all, HasSubstr("w.wrl:3:5: warning: expected a name after DEF, found 'field'; it is read as '_field'"));
  EXPECT_THAT(all, HasSubstr("wall.wrl:1:"));
  EXPECT_THAT(all, HasSubstr("1-2-3"));
}

// Whoever joins gets the archive, and reads it as any world.
TEST_F(LenientWorld, IsTheSameWorldForWhoeverReadsItsArchiveStrictly) {
  const auto file = must(read_world_file(path, {.lenient = true}));
  const auto joined = must(read_world_bytes(pack(archive_of(*file)), "joined.wrl", {}));
  ASSERT_TRUE(joined->result.scene);
  EXPECT_EQ(content_hash(joined->result), content_hash(file->result));
  EXPECT_EQ(joined->text, file->text);
  EXPECT_EQ(content_hash(must(read_world_file(path, {.lenient = true}))->result), content_hash(file->result));
}

TEST_F(LenientWorld, WithoutFaultsIsTheFileItself) {
  const auto good = folder.write("good.wrl", "#VRML V2.0 utf8\n# as it stands\nGroup { }\n");
  const auto file = must(read_world_file(good, {.lenient = true}));
  EXPECT_THAT(file->text, HasSubstr("# as it stands"));
  EXPECT_FALSE(file->as_written);
}

TEST_F(LenientWorld, ThatNobodyCanUnderstandStaysAnError) {
  const auto file = must(read_world_file(folder.write("x.wrl", "#VRML V2.0 utf8\nGroup {"), {.lenient = true}));
  EXPECT_FALSE(file->result.scene);
}

TEST(LocalFiles, RefuseByName) {
  const ScratchFolder folder;
  const auto load = local_files();
  const std::string base = (folder / "w.wrl").string();
  EXPECT_EQ(load("http://h/a", base).error(), "it is no file of this machine");
  EXPECT_EQ(load("none", base).error(), "there is no such file");
  EXPECT_EQ(load(".", base).error(), "it is no regular file");
  folder.write("a", "text");
  EXPECT_EQ(load("a", base)->bytes, "text");
}

}  // namespace peerd::world_file_test
