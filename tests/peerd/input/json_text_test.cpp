#include "peerd/input/json_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::json_text_test {

TEST(JsonLine, IsOneLine) {
  EXPECT_EQ(json_line("a \"b\"\nc"), R"("a \"b\"\nc")");
  EXPECT_EQ(json_line({{"b", {1, 2}}, {"a", nullptr}}), R"({"a":null,"b":[1,2]})");
}

TEST(JsonLine, ReplacesWhatIsNotUtf8) { EXPECT_EQ(json_line("CAF\xc9"), "\"CAF\xef\xbf\xbd\""); }

TEST(JsonText, HasAMemberALineAndKeepsTheOrderOfThoseThatHaveOne) {
  EXPECT_EQ(json_text(nlohmann::ordered_json{{"b", 1}, {"a", "\xc9"}}), "{\n  \"b\": 1,\n  \"a\": \"\xef\xbf\xbd\"\n}");
  EXPECT_EQ(json_text(nlohmann::json{{"b", 1}}, 1), "{\n \"b\": 1\n}");
}

TEST(JsonIfValid, IsDiscardedWhereTheTextIsNotJson) {
  EXPECT_EQ(json_if_valid("[1, 2]"), nlohmann::json({1, 2}));
  EXPECT_TRUE(json_if_valid("[1, 2").is_discarded());
}

}  // namespace peerd::json_text_test
