#include "core/vrml/field_checks.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace peerd::vrml::field_checks_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> messages(Problems& problems) {
  std::vector<std::string> out;
  for (const Diagnostic& d : problems.take().diagnostics) {
    out.push_back((d.severity == Severity::kWarning ? "warning " : "") + d.message);
  }
  return out;
}

struct Case {
  const char* name;
  Range range;
  float value;
  bool good;
  const char* message;  // a part of it; null: none
};
class CheckRange : public testing::TestWithParam<Case> {};
TEST_P(CheckRange, JudgesTheValue) {
  const Case& c = GetParam();
  const std::string text = std::to_string(c.value);
  Problems problems;
  const Position begin = problems.open({"t", text, nullptr}).value();
  const FieldSpec spec{"f", FieldType::kSFFloat, Access::kField, {}, c.range};
  EXPECT_EQ(check_range(spec, {&spec, &c.value, 1, begin}, problems), c.good);
  if (c.message == nullptr) {
    EXPECT_THAT(messages(problems), IsEmpty());
  } else {
    EXPECT_THAT(messages(problems), ElementsAre(HasSubstr(c.message)));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, CheckRange,
    testing::Values(Case{"Any", Range::kAny, -1, true, nullptr}, Case{"Positive", Range::kPositive, 1, true, nullptr},
                    Case{"ZeroIsNotPositive", Range::kPositive, 0, false, "'f' must be > 0"},
                    Case{"ZeroIsNonNegative", Range::kNonNegative, 0, true, nullptr},
                    Case{"Negative", Range::kNonNegative, -1, false, "'f' must be >= 0"},
                    Case{"SizeZero", Range::kSize, 0, true, "warning 'f' should be > 0"},
                    Case{"SizeNegative", Range::kSize, -1, false, "'f' must be > 0"},
                    Case{"ShouldBePositive", Range::kShouldBePositive, -1, true, "warning 'f' should be > 0"},
                    Case{"ShouldBeNonNegative", Range::kShouldBeNonNegative, -1, true, "warning 'f' should be >= 0"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(CheckRange, PointsAtTheElement) {
  const std::string text = "[ 1 2 -3 4 ]";
  const std::vector<float> values = {1, 2, -3, 4};
  Problems problems;
  const Position begin = problems.open({"t", text, nullptr}).value();
  const FieldSpec spec{"f", FieldType::kMFFloat, Access::kField, {}, Range::kPositive};
  EXPECT_FALSE(check_range(spec, {&spec, values.data(), 4, begin}, problems));
  const auto report = problems.take();
  ASSERT_EQ(report.diagnostics.size(), 1u);
  EXPECT_EQ(report.diagnostics[0].offset, text.find("-3"));
}

TEST(CheckNodes, RefusesANodeOfAnotherClass) {
  Problems problems;
  const Position begin = problems.open({"t", "x", nullptr}).value();
  const std::vector<Node> nodes = {{.type = find_node_type("Box")}, {.type = find_node_type("Material")}};
  const FieldSpec geometry{"geometry", FieldType::kSFNode, Access::kField, {}, Range::kAny, kGeometry};
  const NodeRef box{0, begin}, material{1, begin}, null{NodeRef::kNull, begin};
  EXPECT_TRUE(check_nodes(geometry, {&geometry, &box, 1, begin}, nodes, problems));
  EXPECT_TRUE(check_nodes(geometry, {&geometry, &null, 1, begin}, nodes, problems));
  EXPECT_FALSE(check_nodes(geometry, {&geometry, &material, 1, begin}, nodes, problems));
  EXPECT_THAT(messages(problems), ElementsAre("'geometry' takes a geometry node; Material is a Material"));
}

}  // namespace peerd::vrml::field_checks_test
