#include "peerd/net/snapshot/reply_work.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/replication/peer/operations.hpp"

namespace peerd::snapshot::reply_work_test {

using replication::AuthorId;
using replication::LogLength;
using replication::OperationLogs;

class Digesting : public testing::Test {
 protected:
  void append(AuthorId author, std::uint32_t operations, std::size_t large_bytes = 0) {
    std::uint64_t from = 0;
    for (std::uint32_t number = 1; number <= operations; ++number) {
      const replication::OperationId id{author, number};
      const auto operation = large_bytes > 0 ? maker.large(id, large_bytes) : maker.operation(id);
      const auto bytes = replication::encode(operation);
      ASSERT_TRUE(logs.receive({author, from, bytes}));
      from += bytes.size();
    }
  }
  // The digests of these beginnings, and how many steps they take.
  std::pair<std::vector<std::uint64_t>, std::size_t> digests_of(const std::vector<LogLength>& of) {
    ReplyWork work(encode(Request{7, DigestRequest{of}}), content);
    std::size_t steps = 1;
    auto reply = work.step();
    for (; !reply; reply = work.step()) ++steps;
    return {std::get<Digests>(*reply).digests, steps};
  }
  [[nodiscard]] std::uint64_t whole_digest(AuthorId author, std::uint64_t size_bytes) const {
    const auto bytes = logs.bytes({author, 0, size_bytes});
    return digest({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  replication::test::OperationMaker maker{1};
  OperationLogs logs;
  SnapshotContent content{
      7, "town", "", 9, "archive", 1, [this]() -> const OperationLogs& { return logs; }, [] { return SimTime::max(); }};
};

TEST_F(Digesting, ALongLogTakesManySteps) {
  append(AuthorId{5}, 40, 10 * ReplyWork::kStep_bytes / 3);
  const std::uint64_t all = logs.length(AuthorId{5});
  ASSERT_GT(all, 100 * ReplyWork::kStep_bytes);
  for (const std::uint64_t bytes : {all, all - 1, all - 8, std::uint64_t{ReplyWork::kStep_bytes}, std::uint64_t{1}}) {
    const auto [digests, steps] = digests_of({{AuthorId{5}, bytes}});
    EXPECT_EQ(digests, std::vector<std::uint64_t>{whole_digest(AuthorId{5}, bytes)}) << bytes;
    EXPECT_GE(steps, bytes / ReplyWork::kStep_bytes) << bytes;
  }
}

TEST_F(Digesting, ManyShortLogsTakeSomeSteps) {
  std::vector<LogLength> all;
  std::vector<std::uint64_t> expected;
  for (std::uint32_t author = 1; author <= 1000; ++author) {
    append(AuthorId{author}, 1);
    all.push_back({AuthorId{author}, logs.length(AuthorId{author})});
    expected.push_back(whole_digest(AuthorId{author}, all.back().bytes));
  }
  all.push_back({AuthorId{5000}, 10});
  expected.push_back(0);
  const auto [digests, steps] = digests_of(all);
  EXPECT_EQ(digests, expected);
  EXPECT_GE(steps, all.size() / ReplyWork::kStepLogs);
}

}  // namespace peerd::snapshot::reply_work_test
