#include "peerd/input/json_line.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::json_line_test {

TEST(JsonLine, IsOneLine) {
  EXPECT_EQ(json_line("a \"b\"\nc"), R"("a \"b\"\nc")");
  EXPECT_EQ(json_line({{"b", {1, 2}}, {"a", nullptr}}), R"({"a":null,"b":[1,2]})");
}

TEST(JsonLine, ReplacesWhatIsNotUtf8) { EXPECT_EQ(json_line("CAF\xc9"), "\"CAF\xef\xbf\xbd\""); }

}  // namespace peerd::json_line_test
