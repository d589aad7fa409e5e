#include "core/writer/text_writer.hpp"

#include <gtest/gtest.h>

namespace peerd::vrml::text_writer_test {

TEST(TextWriter, IndentsByTwoBlanksADepth) {
  TextWriter out;
  out.begin_line("Group ");
  out.open("{");
  out.line("children");
  out.close("}");
  EXPECT_EQ(out.take(), "Group {\n  children\n}\n");
}

}  // namespace peerd::vrml::text_writer_test
