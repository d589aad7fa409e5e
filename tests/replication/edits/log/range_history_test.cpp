#include "replication/edits/log/range_history.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace peerd::replication::range_history_test {

using namespace std::chrono_literals;
using Ranges = std::vector<OperationRange>;
constexpr AuthorId kOne{1}, kTwo{2};

struct Case {
  const char* name;
  OperationRange what;
  Ranges from, left;
};
class Subtract : public testing::TestWithParam<Case> {};
TEST_P(Subtract, LeavesTheRest) {
  Ranges ranges = GetParam().from;
  subtract(GetParam().what, ranges);
  EXPECT_EQ(ranges, GetParam().left);
}
INSTANTIATE_TEST_SUITE_P(
    Table, Subtract,
    testing::Values(
        Case{"Nothing", {kOne, 5, 9}, {}, {}}, Case{"All", {kOne, 5, 9}, {{kOne, 5, 9}}, {}},
        Case{"TheMiddle", {kOne, 5, 9}, {{kOne, 0, 20}}, {{kOne, 0, 5}, {kOne, 9, 20}}},
        Case{"TheBeginning", {kOne, 5, 9}, {{kOne, 7, 20}}, {{kOne, 9, 20}}},
        Case{"TheEnd", {kOne, 5, 9}, {{kOne, 2, 6}}, {{kOne, 2, 5}}},
        Case{"Beside", {kOne, 5, 9}, {{kOne, 2, 5}, {kOne, 9, 10}}, {{kOne, 2, 5}, {kOne, 9, 10}}},
        Case{"OfAnother", {kOne, 5, 9}, {{kTwo, 5, 9}}, {{kTwo, 5, 9}}},
        Case{"Several", {kOne, 5, 9}, {{kOne, 4, 6}, {kOne, 7, 8}, {kOne, 8, 11}}, {{kOne, 4, 5}, {kOne, 9, 11}}}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(RangeHistory, ForgetsInTime) {
  RangeHistory history;
  history.note(HostTime{1s}, {kOne, 0, 10});
  history.note(HostTime{1s}, {kOne, 10, 20});
  EXPECT_EQ(history.size(), 1u) << "one after the other is one";
  history.note(HostTime{2s}, {kOne, 20, 30});
  EXPECT_EQ(history.without({{kOne, 5, 40}}, HostTime{1s}), (Ranges{{kOne, 30, 40}}));
  EXPECT_EQ(history.without({{kOne, 5, 40}}, HostTime{1500ms}), (Ranges{{kOne, 5, 20}, {kOne, 30, 40}}));
  history.forget_before(HostTime{2s});
  EXPECT_EQ(history.without({{kOne, 5, 40}}, HostTime{0s}), (Ranges{{kOne, 5, 20}, {kOne, 30, 40}}));
}

TEST(RangeHistory, IsLimited) {
  RangeHistory history;
  for (std::uint64_t i = 0; i < 100'000; ++i) history.note(HostTime{1s}, {kOne, 2 * i, 2 * i + 1});
  EXPECT_LE(history.size(), 4096u);
}

// Byte by byte, a set says the same.
TEST(RangeHistory, AgreesWithASet) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    RangeHistory history;
    std::set<std::uint64_t> noted;
    for (auto n = random() % 10; n > 0; --n) {
      const std::uint64_t from = random() % 90, to = from + 1 + random() % 10;
      history.note(HostTime{1s}, {kOne, from, to});
      for (std::uint64_t b = from; b < to; ++b) noted.insert(b);
    }
    std::set<std::uint64_t> left;
    for (const OperationRange& range : history.without({{kOne, 10, 80}}, HostTime{0s})) {
      for (std::uint64_t b = range.from; b < range.to; ++b) EXPECT_TRUE(left.insert(b).second);
    }
    for (std::uint64_t b = 10; b < 80; ++b) EXPECT_EQ(left.contains(b), !noted.contains(b));
  }
}

}  // namespace peerd::replication::range_history_test
