#include "core/writer/text_writer.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace peerd::vrml::text_writer_test {

TEST(TextWriter, IndentsByTwoBlanksADepth) {
  TextWriter out;
  out.begin_line("Group ");
  out.open("{");
  out.line("children");
  out.close("}");
  EXPECT_EQ(out.take(), "Group {\n  children\n}\n");
}

template <class T>
std::string written(FieldType type, const std::vector<T>& values) {
  const FieldSpec spec{"f", type, Access::kField, {}};
  TextWriter out;
  out.begin_line("f ");
  out.value({&spec, values.data(), static_cast<std::uint32_t>(values.size()), 0});
  return out.take();
}

TEST(TextWriter, WritesTheShortestNumbersThatReadBackTheSame) {
  EXPECT_EQ(written<float>(FieldType::kSFFloat, {0.1f}), "f 0.1\n");
  EXPECT_EQ(written<float>(FieldType::kSFVec3f, {1, -2.5f, 0}), "f 1 -2.5 0\n");
  EXPECT_EQ(written<std::int32_t>(FieldType::kSFInt32, {-7}), "f -7\n");
}

TEST(TextWriter, PutsListsIntoBrackets) {
  EXPECT_EQ(written<float>(FieldType::kMFFloat, {}), "f [ ]\n");
  EXPECT_EQ(written<std::int32_t>(FieldType::kMFInt32, {0, 1, 2, -1}), "f [ 0 1 2 -1 ]\n");
}

TEST(TextWriter, WrapsLongListsWithinItsWidth) {
  const std::string text = written<std::int32_t>(FieldType::kMFInt32, std::vector<std::int32_t>(200, 12345));
  std::size_t begin = 0, lines = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    EXPECT_LE(end - begin, TextWriter::kWidth + 10);
    ++lines;
  }
  EXPECT_GT(lines, 10u);
}

TEST(StringText, EscapesQuotesAndBackslashes) {
  EXPECT_EQ(string_text("a"), "\"a\"");
  EXPECT_EQ(string_text("say \"x\\y\""), "\"say \\\"x\\\\y\\\"\"");
}

}  // namespace peerd::vrml::text_writer_test
