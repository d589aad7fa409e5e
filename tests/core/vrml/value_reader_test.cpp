#include "core/vrml/value_reader.hpp"

#include <gmock/gmock.h>

namespace peerd::vrml::value_reader_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Reader {
  explicit Reader(std::string_view text)
      : tokens(text, problems.open({"t", text, nullptr}).value(), 0, problems), reader(tokens, arena, problems) {}
  std::optional<Field> read(FieldType type, Range range = Range::kAny) {
    spec = {"field", type, Access::kField, {}, range, kAnyClass};
    return reader.read(spec);
  }
  std::vector<std::string> messages() {
    std::vector<std::string> out;
    for (const Diagnostic& d : problems.take().diagnostics) out.push_back(d.message);
    return out;
  }
  Arena arena;
  Problems problems;
  TokenStream tokens;
  ValueReader reader;
  FieldSpec spec{};
};

TEST(ValueReader, ReadsOneValueAsAListOfOne) {
  Reader r("7 rest");
  const auto field = r.read(FieldType::kMFInt32);
  ASSERT_TRUE(field);
  EXPECT_THAT(field->as<std::int32_t>(), ElementsAre(7));
  EXPECT_TRUE(r.tokens.at_word("rest"));
}

TEST(ValueReader, ReadsListsWithAndWithoutCommas) {
  Reader r("[ 1 2, 3,4 ] [ ]");
  EXPECT_THAT(r.read(FieldType::kMFFloat)->as<float>(), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(r.read(FieldType::kMFFloat)->count, 0u);
}

struct Bad {
  const char* name;
  const char* text;
  FieldType type;
  const char* message;
};
class BadValue : public testing::TestWithParam<Bad> {};
TEST_P(BadValue, IsReportedAndGivesNothing) {
  Reader r(GetParam().text);
  EXPECT_FALSE(r.read(GetParam().type, Range::kPositive));
  EXPECT_THAT(r.messages(), ElementsAre(HasSubstr(GetParam().message)));
}
INSTANTIATE_TEST_SUITE_P(
    Table, BadValue,
    testing::Values(Bad{"WordForNumber", "fast", FieldType::kSFFloat, "'field' (SFFloat) wants a number, found 'fast'"},
                    Bad{"NumberForBool", "1", FieldType::kSFBool, "'field' (SFBool)"},
                    Bad{"NumberForString", "1", FieldType::kSFString, "'field' (SFString)"},
                    Bad{"FractionForInteger", "1.5", FieldType::kSFInt32, "'1.5' is not a number of SFInt32"},
                    Bad{"OutOfRange", "-1", FieldType::kSFFloat, "'field' must be > 0, found '-1'"},
                    Bad{"UnclosedList", "[ 1 2", FieldType::kMFFloat, "this list is never closed: a ']' is missing"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ValueReader, LeavesTheRangeToTheCallerOnRequest) {
  Reader r("-1");
  r.spec = {"field", FieldType::kSFFloat, Access::kField, {}, Range::kPositive, kAnyClass};
  EXPECT_TRUE(r.reader.read(r.spec, false));
  EXPECT_THAT(r.messages(), IsEmpty());
}

TEST(ValueReader, ReadsNodesThroughItsParser) {
  Reader r("[ x x ] y");
  std::uint32_t next = 5;
  r.reader.set_parser(
      [&](const FieldSpec&) -> std::optional<NodeRef> {
        r.tokens.take();
        return NodeRef{next++, 0};
      },
      [](std::string_view) { return false; });
  const auto field = r.read(FieldType::kMFNode);
  ASSERT_TRUE(field);
  ASSERT_EQ(field->count, 2u);
  EXPECT_EQ(field->as<NodeRef>()[1].index, 6u);
}

TEST(ValueReader, SeesThatAListIsOverAtTheNextField) {
  Reader r("[ 1 2 radius 3");
  r.reader.set_parser([](const FieldSpec&) -> std::optional<NodeRef> { return std::nullopt; },
                      [](std::string_view word) { return word == "radius"; });
  EXPECT_FALSE(r.read(FieldType::kMFFloat));
  EXPECT_TRUE(r.tokens.at_word("radius"));
  EXPECT_THAT(r.messages(), ElementsAre("expected ']', found 'radius'"));
}

// The names of node types and of fields are separate: a PROTO may be called as a field of the node around it.
TEST(ValueReader, AWordBeforeABraceIsANodeAndNoField) {
  Reader r("[ radius { } radius { } ] radius 3");
  r.reader.set_parser(
      [&](const FieldSpec&) {
        r.tokens.take();
        r.tokens.skip_balanced();
        return NodeRef{5, 0};
      },
      [](std::string_view word) { return word == "radius"; });
  const auto field = r.read(FieldType::kMFNode);
  ASSERT_TRUE(field);
  EXPECT_EQ(field->as<NodeRef>().size(), 2u);
  EXPECT_THAT(r.messages(), IsEmpty());
  EXPECT_TRUE(r.tokens.at_word("radius"));
}

}  // namespace peerd::vrml::value_reader_test
