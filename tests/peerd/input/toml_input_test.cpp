#include "peerd/input/toml_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::toml_input_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// A table with one key of each type, as read from `text`, and the error's text, or "".
struct Settings {
  double length_m = 1.5;
  std::optional<double> maybe;
  std::uint32_t count = 3;
  std::uint64_t seed = 7;
  std::string name = "n";
  std::vector<std::string> names{"old"};
  std::vector<double> axis{0, 1, 0};
  std::size_t word = 0;
  std::string error;
};
Settings read(const std::string& text) {
  Settings s;
  const auto table = parse_toml(text, "my.toml");
  if (!table) {
    s.error = table.error().text;
    return s;
  }
  std::optional<InputError> error;
  TomlReader reader(*table, "", error);
  reader.read("length_m", s.length_m, 0.0, 10.0);
  reader.read("maybe", s.maybe, -1.0, 1.0);
  reader.read("count", s.count, 1, 5);
  reader.read("seed", s.seed);
  reader.read("name", s.name);
  reader.read("names", s.names);
  reader.read("axis", s.axis, 3);
  reader.read_word("word", s.word, {"run", "hold"});
  if (const toml::table* sub = reader.table("sub")) {
    TomlReader sub_reader(*sub, reader.dotted("sub"), reader.error());
    double x = 0;
    sub_reader.read("x", x, 0.0, 1.0);
    sub_reader.require("x");
    sub_reader.finish();
  }
  reader.finish();
  if (error) {
    EXPECT_EQ(error->exit_code, 2);
    s.error = error->text;
  }
  return s;
}

TEST(TomlReader, LeavesWhatIsNotGiven) {
  const Settings s = read("");
  EXPECT_EQ(s.error, "");
  EXPECT_EQ(s.length_m, 1.5);
  EXPECT_FALSE(s.maybe);
  EXPECT_EQ(s.count, 3u);
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(s.name, "n");
  EXPECT_THAT(s.names, ElementsAre("old"));
}

TEST(TomlReader, ReadsEveryType) {
  const Settings s = read(R"(length_m = 2
maybe = 0.0
count = 5
seed = 9223372036854775807
name = "x y"
names = ["a", "b"]
axis = [1, 0.5, -2]
word = "hold"
sub.x = 1)");
  EXPECT_EQ(s.error, "");
  EXPECT_EQ(s.length_m, 2.0) << "a whole number is a number";
  EXPECT_EQ(s.maybe, 0.0);
  EXPECT_EQ(s.count, 5u);
  EXPECT_EQ(s.seed, 9223372036854775807u);
  EXPECT_EQ(s.name, "x y");
  EXPECT_THAT(s.names, ElementsAre("a", "b"));
  EXPECT_THAT(s.axis, ElementsAre(1, 0.5, -2));
  EXPECT_EQ(s.word, 1u);
}

struct Bad {
  const char *name, *text, *where, *sentence;
};
class TomlRefusal : public testing::TestWithParam<Bad> {};
TEST_P(TomlRefusal, SaysWhereAndWhat) {
  const std::string error = read(GetParam().text).error;
  EXPECT_THAT(error, StartsWith(std::string("my.toml:") + GetParam().where + ": error: "));
  EXPECT_THAT(error, HasSubstr(GetParam().sentence));
  EXPECT_EQ(error.find('\n'), std::string::npos) << "one sentence: " << error;
}
INSTANTIATE_TEST_SUITE_P(
    Table, TomlRefusal,
    testing::Values(Bad{"UnknownKey", "count = 2\nlenght_m = 3", "2:1", "unknown key lenght_m; did you mean length_m?"},
                    Bad{"UnknownKeyFarFromAny", "\n  colour = 3", "2:3", "unknown key colour"},
                    Bad{"UnknownKeyInATable", "[sub]\nx = 1\nxx = 2", "3:1", "unknown key sub.xx; did you mean sub.x?"},
                    Bad{"MissingKey", "count = 1\n[sub]", "2:1", "sub.x is missing"},
                    Bad{"NotATable", "sub = 3", "1:7", "sub must be a table"},
                    Bad{"NotANumber", "length_m = \"3\"", "1:12", "length_m must be a number"},
                    Bad{"BooleanIsNoNumber", "length_m = true", "1:12", "length_m must be a number"},
                    Bad{"TooSmall", "length_m = -0.1", "1:12", "length_m = -0.1 is out of range: 0 to 10"},
                    Bad{"TooLarge", "length_m = 1e9", "1:12", "length_m = 1000000000 is out of range: 0 to 10"},
                    Bad{"NanIsOutOfEveryRange", "length_m = nan", "1:12", "out of range"},
                    Bad{"InfinityIsOutOfEveryRange", "length_m = inf", "1:12", "out of range"},
                    Bad{"OptionalIsCheckedToo", "maybe = 2", "1:9", "maybe = 2 is out of range: -1 to 1"},
                    Bad{"NotWhole", "count = 2.5", "1:9", "count must be a whole number"},
                    Bad{"CountOutOfRange", "count = 6", "1:9", "count = 6 is out of range: 1 to 5"},
                    Bad{"SeedNegative", "seed = -1", "1:8", "seed must be a whole number, not negative"},
                    Bad{"SeedNotWhole", "seed = 1.0", "1:8", "seed must be a whole number"},
                    Bad{"NotAString", "name = 3", "1:8", "name must be a string"},
                    Bad{"NotAList", "names = \"a\"", "1:9", "names must be a list of strings"},
                    Bad{"ListOfOtherThings", "names = [\"a\", 3]", "1:15", "names must be a list of strings"},
                    Bad{"ListTooShort", "axis = [1, 2]", "1:8", "axis must be a list of 3 numbers"},
                    Bad{"ListNotOfNumbers", "axis = [1, 2, \"z\"]", "1:15", "axis must be a list of 3 numbers"},
                    Bad{"NotOneOfTheWords", "word = \"walk\"", "1:8", "word must be one of"},
                    Bad{"MalformedToml", "count = \nname = \"x\"", "1:9", "expected value"},
                    Bad{"SameKeyTwice", "count = 1\ncount = 2", "2:9", "count"},
                    Bad{"StringWithoutEnd", "name = \"x", "1:10", "string"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(TomlReader, TheFirstErrorWins) {
  EXPECT_THAT(read("length_m = -1\ncount = 9\nwhat = 1").error, HasSubstr("length_m = -1"));
}

TEST(DidYouMean, FindsWhatIsClose) {
  const std::vector<std::string> words{"latency_ms", "jitter_ms", "loss"};
  EXPECT_EQ(did_you_mean("latncy_ms", words), "latency_ms");
  EXPECT_EQ(did_you_mean("los", words), "loss");
  EXPECT_EQ(did_you_mean("loss", words), "loss");
  EXPECT_EQ(did_you_mean("colour", words), std::nullopt);
  EXPECT_EQ(did_you_mean("", words), std::nullopt);
  EXPECT_EQ(did_you_mean("x", {}), std::nullopt);
}

TEST(ParseAssignment, ValueIsTomlOrElseAString) {
  const auto value = [](const std::string& text) {
    const auto a = must(parse_assignment(text));
    std::ostringstream out;
    out << a.holder;
    return a.key + " | " + out.str();
  };
  EXPECT_EQ(value("a.b=3"), "a.b | value = 3");
  EXPECT_EQ(value("a=0.5"), "a | value = 0.5");
  EXPECT_EQ(value("a=[1, 2]"), "a | value = [ 1, 2 ]");
  EXPECT_EQ(value("a=\"dr\""), "a | value = 'dr'");
  EXPECT_EQ(value("a=dr+rcp"), "a | value = 'dr+rcp'");
  EXPECT_EQ(value("x=s = 2"), "x | value = 's = 2'");
  EXPECT_EQ(value("a=1\nb = 2"), "a | value = '''1\nb = 2'''") << "one value, not a file";
  EXPECT_EQ(value("a="), "a | value = ''");
  for (const char* wrong : {"a", "", "=3"}) {
    const auto refused = parse_assignment(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_THAT(refused.error().text, HasSubstr("write it as KEY=VALUE"));
  }
}

TEST(Assign, MakesTablesOnTheWayAndReplaces) {
  toml::table root = *parse_toml("a = 1\n[t]\nx = 1\ny = 2", "f");
  ASSERT_TRUE(assign(root, "t.x", toml::value(5)));
  ASSERT_TRUE(assign(root, "new.deep.key", toml::value("v")));
  EXPECT_EQ(root, *parse_toml("a = 1\n[t]\nx = 5\ny = 2\n[new.deep]\nkey = \"v\"", "f"));
  EXPECT_THAT(error_of(assign(root, "a.b", toml::value(1))).text, HasSubstr("a.b: a is a value, not a table"));
}

TEST(Assign, TheItemsOfAListGoByNumber) {
  toml::table root = toml::parse("key = [{at_s = 1}, {at_s = 2}]\nv = [1, 2, 3]");
  const toml::table value{{"x", 9}};
  ASSERT_TRUE(assign(root, "key.1.at_s", *value.get("x")));
  ASSERT_TRUE(assign(root, "v.0", *value.get("x")));
  EXPECT_EQ(root["key"][1]["at_s"].value<int>(), 9);
  EXPECT_EQ(root["key"][0]["at_s"].value<int>(), 1);
  EXPECT_EQ(root["v"][0].value<int>(), 9);
  EXPECT_EQ(find(root, "key.1.at_s")->value<int>(), 9);
  EXPECT_EQ(find(root, "key.2.at_s"), nullptr);
  EXPECT_EQ(find(root, "v.x"), nullptr);
  EXPECT_THAT(assign(root, "v.3", *value.get("x")).error().text, testing::HasSubstr("the list has 3 items"));
  EXPECT_THAT(assign(root, "key.5.at_s", *value.get("x")).error().text,
              testing::HasSubstr("key.5 is no item of a list"));
}

TEST(Merge, OverWinsTableByTable) {
  toml::table base = *parse_toml("a = 1\nlist = [1, 2]\n[t]\nx = 1\ny = 2\n[v]\nz = 1", "f");
  merge(base, *parse_toml("a = 2\nlist = [3]\nv = 7\nw = 8\n[t]\ny = 3", "f"));
  EXPECT_EQ(base, *parse_toml("a = 2\nlist = [3]\nv = 7\nw = 8\n[t]\nx = 1\ny = 3", "f"));
}

TEST(TomlReader, NumbersAreFiniteAndInRange) {
  EXPECT_THAT(read("length_m = nan").error, HasSubstr("length_m = nan is out of range: 0 to 10"));
  EXPECT_THAT(read("length_m = inf").error, HasSubstr("length_m = inf is out of range: 0 to 10"));
  EXPECT_NE(read("length_m = 1e400").error, "");
  EXPECT_THAT(read("axis = [0, nan, 0]").error, HasSubstr("axis must be a list of 3 numbers; nan is out of range"));
  EXPECT_THAT(read("axis = [0, 1e10, 0]").error, HasSubstr("10000000000 is out of range: -1000000000 to 1000000000"));
}

}  // namespace peerd::toml_input_test
