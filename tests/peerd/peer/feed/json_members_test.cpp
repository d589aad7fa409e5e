#include "peerd/peer/feed/json_members.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::feed::json_members_test {

using nlohmann::json;
using testing::HasSubstr;

struct Line {
  const char *name, *line;
  const char* error;  // empty: the line is accepted
};
class ParseJsonObject : public testing::TestWithParam<Line> {};
TEST_P(ParseJsonObject, TakesOneObjectWithoutDuplicateNames) {
  const auto object = parse_json_object(GetParam().line);
  EXPECT_EQ(object.has_value(), *GetParam().error == '\0');
  if (!object) {
    EXPECT_THAT(object.error(), HasSubstr(GetParam().error));
  }
}
INSTANTIATE_TEST_SUITE_P(Table, ParseJsonObject,
                         testing::Values(Line{"Empty", "{}", ""}, Line{"WithALineEnd", "{\"a\":1}\r", ""},
                                         Line{"NoText", "", "not JSON"}, Line{"TwoObjects", "{} {}", "not JSON"},
                                         Line{"NaN", "{\"a\":NaN}", "no NaN"},
                                         Line{"Infinite", "{\"a\":1e999}", "no 1e999"},
                                         Line{"AList", "[{}]", "no object"},
                                         Line{"Twice", R"({"a":1,"b":2,"a":1})", "\"a\" is given twice"},
                                         Line{"TwiceInside", R"({"b":[{"a":1,"a":1}]})", "\"a\" is given twice"},
                                         Line{"OnceInEachObject", R"({"a":{"a":1},"b":[{"a":1},{"a":1}]})", ""}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(JsonMembers, GiveTheirValues) {
  const json object = json::parse(R"({"t":"x","f":true,"w":-3,"n":2.5,"v":[1,2,3],"q":[1,2,3,4],"o":[{"a":1},{}]})");
  JsonMembers members(object);
  EXPECT_EQ(members.text("t"), "x");
  EXPECT_TRUE(members.flag("f"));
  EXPECT_EQ(members.whole("w", 0, -3, 3), -3);
  EXPECT_EQ(members.number("n"), 2.5);
  EXPECT_EQ(members.numbers<3>("v"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(members.numbers<4>("q"), Eigen::Vector4d(1, 2, 3, 4));
  EXPECT_EQ(members.objects("o").size(), 2u);
  EXPECT_EQ(members.finish(), "");
}

TEST(JsonMembers, MissingOnesHaveDefaults) {
  const json object = json::object();
  JsonMembers members(object);
  EXPECT_EQ(members.text("t"), std::nullopt);
  EXPECT_FALSE(members.flag("f"));
  EXPECT_TRUE(members.flag("g", true));
  EXPECT_EQ(members.whole("w", 7, 0, 3), 7);
  EXPECT_EQ(members.number("n"), std::nullopt);
  EXPECT_EQ(members.numbers<3>("v"), std::nullopt);
  EXPECT_TRUE(members.objects("o").empty());
  EXPECT_EQ(members.finish(), "");
  EXPECT_EQ(members.required(members.text("t"), "t"), "");
  EXPECT_EQ(members.finish(), "\"t\" is missing");
}

TEST(JsonMembers, TheFirstErrorWins) {
  const json object = json::parse(R"({"a":1,"b":2,"unknown":3})");
  JsonMembers members(object);
  (void)members.text("a");
  (void)members.flag("b");
  EXPECT_EQ(members.finish(), "\"a\" must be a string");
}

TEST(JsonMembers, OneThatNobodyAskedForIsAnErrorWithASuggestion) {
  const json object = json::parse(R"({"positon":1})");
  JsonMembers members(object);
  (void)members.number("position");
  EXPECT_EQ(members.finish(), "unknown member \"positon\"; did you mean \"position\"?");
}

TEST(JsonMembers, WholeNumbersHaveLimits) {
  const auto wrong = [](const char* text) {
    const json object = json::parse(text);
    JsonMembers members(object);
    EXPECT_EQ(members.whole("w", 5, 0, 10), 5);
    return members.finish();
  };
  for (const char* text :
       {R"({"w":-1})", R"({"w":11})", R"({"w":1.5})", R"({"w":"1"})", R"({"w":18446744073709551615})"}) {
    EXPECT_EQ(wrong(text), "\"w\" must be a whole number from 0 to 10") << text;
  }
  const json object = json::parse(R"({"a":0,"b":10})");
  JsonMembers members(object);
  EXPECT_EQ(members.whole("a", 5, 0, 10), 0);
  EXPECT_EQ(members.whole("b", 5, 0, 10), 10);
}

TEST(JsonMembers, ListsHaveTheirLengthAndTheirKind) {
  const auto wrong = [](const char* text) {
    const json object = json::parse(text);
    JsonMembers members(object);
    EXPECT_FALSE(members.numbers<3>("v"));
    return members.finish();
  };
  for (const char* text : {R"({"v":[1,2]})", R"({"v":[1,2,3,4]})", R"({"v":[1,2,"3"]})", R"({"v":3})"}) {
    EXPECT_EQ(wrong(text), "\"v\" must be a list of 3 numbers") << text;
  }
}

TEST(JsonMembers, AnotherVersionIsRefused) {
  const json ours = json::parse(R"({"v":1})"), other = json::parse(R"({"v":2})"), none = json::object();
  EXPECT_TRUE(JsonMembers(ours).check_version());
  EXPECT_TRUE(JsonMembers(none).check_version());
  EXPECT_EQ(error_of(JsonMembers(other).check_version()), "version 2 is not spoken here; this is version 1");
}

}  // namespace peerd::feed::json_members_test
