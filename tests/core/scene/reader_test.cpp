#include "core/scene/reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::reader_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kSized = "DEF I Inline { url \"a.wrl\" bboxSize 1 1 1 }";

TEST(ReadWorld, HasASceneExactlyWhereThereIsNoError) {
  EXPECT_TRUE(read_body("Group { }").scene);
  EXPECT_TRUE(read_body("Material { }").scene);  // a warning
  EXPECT_FALSE(read_body("Grupo { }").scene);
}

TEST(ReadWorld, ListsItsSourcesInTheOrderOfReading) {
  const ReadResult result =
      read_body("Inline { url \"b.wrl\" } Inline { url \"a.wrl\" }", {{"a.wrl", "Group { }"}, {"b.wrl", "Group { }"}});
  std::vector<std::string> names;
  for (const Source& source : result.sources) names.push_back(source.name);
  EXPECT_THAT(names, ElementsAre(kWorldName, "b.wrl", "a.wrl"));
}

TEST(ReadWorld, ReadsAnInlineThatCollides) {
  ReadOptions options;
  options.defer_inlines = true;
  const Scene scene = scene_of(std::string(kSized) +
                                   "DEF B Shape { geometry Box { } } CollisionInterest { objectPath \"I\" interests "
                                   "\"B\" }",
                               {{"a.wrl", "Shape { geometry Box { } }"}}, options);
  EXPECT_THAT(scene.pending_inlines, IsEmpty());
  EXPECT_EQ(scene.instances.size(), 3u);
}

TEST(ReadInline, TakesTheFirstUrlThatCanBeRead) {
  ReadOptions options;
  options.load = loader_of({{"b.wrl", "Group { } Group { }"}});
  const PendingInline pending{
      ObjectId{0}, Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones(), {"a.wrl", "b.wrl"}, kWorldName};
  const ReadResult result = read_inline(pending, options);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(result.scene->instances.size(), 2u);
  EXPECT_NE(result.sources.at(0).owned, nullptr);
}

TEST(ReadInline, SaysWhatItHasTried) {
  const PendingInline pending{ObjectId{0}, Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones(), {"a.wrl"}, kWorldName};
  const ReadResult result = read_inline(pending, {});
  EXPECT_FALSE(result.scene);
  EXPECT_THAT(lines_of(result), ElementsAre(HasSubstr("'a.wrl': no other file is read here")));
}

TEST(ContentHash, DependsOnEveryByteOfEveryText) {
  const Files files = {{"a.wrl", "Group { }"}};
  const std::string body = "Inline { url \"a.wrl\" }";
  const std::uint64_t hash = content_hash(read_body(body, files));
  EXPECT_EQ(content_hash(read_body(body, files)), hash);
  EXPECT_NE(content_hash(read_body(body + " ", files)), hash);
  EXPECT_NE(content_hash(read_body(body, {{"a.wrl", "Group {  }"}})), hash);
  EXPECT_EQ(content_hash(ReadResult{}), 14695981039346656037u);
}

}  // namespace peerd::reader_test
