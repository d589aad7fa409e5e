#include "peerd/cli/shell/error_json.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

namespace peerd::error_json_test {

using Json = nlohmann::ordered_json;

Json only_error(const std::string& text) {
  const Json json = error_json(InputError{text});
  EXPECT_EQ(json["good"], false);
  EXPECT_EQ(json["errors"].size(), 1u) << json;
  return json["errors"][0];
}

TEST(ErrorJson, TakesThePlaceOutOfTheSentence) {
  EXPECT_EQ(only_error("a/s.toml:3:7: error: unknown key x\n"),
            Json::parse(R"({"file": "a/s.toml", "line": 3, "column": 7, "message": "unknown key x"})"));
  EXPECT_EQ(only_error("t.csv:12: error: write 4 numbers"),
            Json::parse(R"({"file": "t.csv", "line": 12, "column": 0, "message": "write 4 numbers"})"));
  EXPECT_EQ(only_error("C:/w.wrl: error: there is no such file"),
            Json::parse(R"({"file": "C:/w.wrl", "line": 0, "column": 0, "message": "there is no such file"})"));
  EXPECT_EQ(only_error("error: which peer? Say --peer NAME\nSee peerd run --help"),
            Json::parse(R"({"file": "", "line": 0, "column": 0, "message": "which peer? Say --peer NAME"})"));
  EXPECT_EQ(only_error("no form at all"),
            Json::parse(R"({"file": "", "line": 0, "column": 0, "message": "no form at all"})"));
}

TEST(ErrorJson, HasAllErrorsOfAText) {
  const Json json =
      error_json(InputError{"w.wrl:1:2: error: a\n  source\n  ^\nw.wrl:3:4: warning: b\nw.wrl:5:6: error: c\n"});
  ASSERT_EQ(json["errors"].size(), 2u);
  EXPECT_EQ(json["errors"][1], Json::parse(R"({"file": "w.wrl", "line": 5, "column": 6, "message": "c"})"));
}

TEST(ErrorJson, IsOneLineAndUtf8) {
  std::ostringstream out;
  print_error_json(error_json(InputError{"\xff.toml: error: there is no such file"}), out);
  EXPECT_EQ(out.str().find('\n'), out.str().size() - 1);
  EXPECT_EQ(Json::parse(out.str())["errors"][0]["file"], "\xEF\xBF\xBD.toml");
}

}  // namespace peerd::error_json_test
