#include "replication/edits/log/operation_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/replication/peer/operations.hpp"

namespace peerd::replication::operation_log_test {

using test::log_of;
using test::OperationMaker;

constexpr AuthorId kOne{3}, kTwo{9};

OperationPart part_of(const std::vector<std::byte>& log, AuthorId author, std::size_t from, std::size_t to) {
  return {
      author, from, {log.begin() + static_cast<std::ptrdiff_t>(from), log.begin() + static_cast<std::ptrdiff_t>(to)}};
}
OperationPart whole(const std::vector<std::byte>& log, AuthorId author) { return part_of(log, author, 0, log.size()); }
std::string error_of(OperationLogs& logs, const OperationPart& part) {
  const auto taken = logs.receive(part);
  return taken ? "none" : taken.error();
}
std::vector<std::byte> held(const OperationLogs& logs, AuthorId author) {
  const auto bytes = logs.bytes({author, 0, logs.length(author)});
  return {bytes.begin(), bytes.end()};
}

TEST(OperationLogs, AppendAndReceiveAgree) {
  OperationLogs author(kOne), other(kTwo);
  OperationMaker make(1);
  for (std::uint32_t number = 1; number <= 50; ++number) {
    const Operation o = make.operation({kOne, number});
    const std::uint64_t before = author.length(kOne);
    ASSERT_TRUE(author.append(o));
    const auto bytes = author.bytes({kOne, before, author.length(kOne)});
    const auto taken = other.receive({kOne, before, {bytes.begin(), bytes.end()}});
    ASSERT_TRUE(taken) << taken.error();
    ASSERT_EQ(taken->size(), 1u);
    EXPECT_TRUE(test::same(taken->front(), o));
    EXPECT_EQ(author.lengths(), other.lengths());
  }
  EXPECT_FALSE(author.empty());
  EXPECT_EQ(other.last(kOne), (OperationId{kOne, 50}));
  EXPECT_EQ(other.last_stamp(kOne), author.last_stamp(kOne));
}

TEST(OperationLogs, RefuseToAppendWhatNobodyCouldRead) {
  OperationLogs logs(kOne);
  const auto large = logs.append(OperationMaker(1).large({kOne, 1}, kOperationMax_bytes + 1));
  ASSERT_FALSE(large);
  EXPECT_STREQ(large.error(), "operation_too_large");
  const auto empty = logs.append({{kOne, 1}, SimTime{}, SetField{NodeId{1}, "", "1", 0}});
  ASSERT_FALSE(empty);
  EXPECT_STREQ(empty.error(), "operation_text");
  EXPECT_EQ(logs.length(kOne), 0u);
  EXPECT_TRUE(logs.append(OperationMaker(1).large({kOne, 1}, kOperationMax_bytes - 100)));
}

// Any cut into parts, in any order, with any overlaps and copies: each operation comes out once, in its order.
TEST(OperationLogs, TakePartsInAnyOrder) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<Operation> operations;
    const auto log = log_of(kOne, 30, seed, &operations);
    OperationMaker make(seed);
    std::vector<std::size_t> cuts{0, log.size()};
    for (auto i = make.random() % 60; i > 0; --i) cuts.push_back(make.random() % log.size());
    std::ranges::sort(cuts);
    std::vector<OperationPart> parts;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      const std::size_t from = cuts[i] - make.random() % (cuts[i] + 1) % 50;
      const std::size_t to = std::min(log.size(), cuts[i + 1] + make.random() % 50);
      if (from < to) parts.push_back(part_of(log, kOne, from, to));
      if (make.random() % 4 == 0 && from < to) parts.push_back(parts.back());
    }
    for (std::size_t i = parts.size(); i > 1; --i) std::swap(parts[i - 1], parts[make.random() % i]);
    OperationLogs logs;
    std::vector<Operation> out;
    for (const OperationPart& part : parts) {
      auto taken = logs.receive(part);
      ASSERT_TRUE(taken) << taken.error();
      std::ranges::move(*taken, std::back_inserter(out));
    }
    ASSERT_EQ(out.size(), operations.size());
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_TRUE(test::same(out[i], operations[i])) << i;
    EXPECT_EQ(held(logs, kOne), log);
    EXPECT_EQ(logs.ahead_bytes(), 0u);
  }
}

TEST(OperationLogs, SayWhatIsMissing) {
  const auto log = log_of(kOne, 100, 4);
  ASSERT_GT(log.size(), 1000u);
  OperationLogs logs;
  const LogLength all{kOne, log.size()};
  EXPECT_EQ(logs.missing({&all, 1}), (std::vector<OperationRange>{{kOne, 0, log.size()}}));
  ASSERT_TRUE(logs.receive(part_of(log, kOne, 0, 100)));
  ASSERT_TRUE(logs.receive(part_of(log, kOne, 300, 400)));
  ASSERT_TRUE(logs.receive(part_of(log, kOne, 500, 600)));
  EXPECT_EQ(logs.length(kOne), 100u);
  EXPECT_EQ(logs.missing({&all, 1}),
            (std::vector<OperationRange>{{kOne, 100, 300}, {kOne, 400, 500}, {kOne, 600, log.size()}}));
  const std::vector<LogLength> less{{kOne, 350}, {kTwo, 8}};
  EXPECT_EQ(logs.missing(less), (std::vector<OperationRange>{{kOne, 100, 300}, {kTwo, 0, 8}}));
  EXPECT_EQ(logs.bytes({kOne, 50, 500}).size(), 50u);
  EXPECT_EQ(logs.bytes({kOne, 100, 500}).size(), 0u);
  EXPECT_EQ(logs.bytes({kTwo, 0, 500}).size(), 0u);
}

// Most of a long log is packed: it has the same bytes and operations, and refuses others.
TEST(OperationLogs, OldOperationsCanBeRead) {
  OperationLogs logs(kOne);
  OperationMaker make(7);
  std::vector<Operation> own;
  std::vector<std::byte> all;
  while (all.size() < 20 * LogBytes::kBlock_bytes) {
    const OperationId id{kOne, static_cast<std::uint32_t>(own.size() + 1)};
    own.push_back(own.size() % 500 == 99 ? make.large(id, 50'000) : make.operation(id));
    const auto bytes = encode(own.back());
    all.insert(all.end(), bytes.begin(), bytes.end());
    ASSERT_TRUE(logs.append(own.back()));
  }
  std::vector<Operation> others;
  const auto log = log_of(kTwo, 3000, 8, &others);
  ASSERT_TRUE(logs.receive(whole(log, kTwo)));
  EXPECT_EQ(held(logs, kOne), all);
  EXPECT_EQ(held(logs, kTwo), log);
  for (std::size_t i = 0; i < 3000; ++i) {
    const Operation &one = own[make.random() % own.size()], &two = others[make.random() % others.size()];
    EXPECT_TRUE(test::same(logs.operation(one.id), one));
    EXPECT_TRUE(test::same(logs.operation(two.id), two));
  }
  EXPECT_EQ(logs.held_bytes({kTwo, 10, log.size() + 5}), log.size() - 10);
  EXPECT_EQ(logs.held_bytes({kTwo, log.size() + 2, log.size() + 5}), 0u);
  EXPECT_EQ(error_of(logs, part_of(log, kTwo, 40'000, 90'000)), "none") << "it is known";
  auto other = part_of(log, kTwo, 40'000, 90'000);
  other.bytes.back() ^= std::byte{1};
  EXPECT_EQ(error_of(logs, other), "forked_log");
  EXPECT_EQ(held(logs, kTwo), log);
}

TEST(OperationLogs, AFork) {
  const auto log = log_of(kOne, 20, 5), other = log_of(kOne, 20, 6);
  OperationLogs logs;
  ASSERT_TRUE(logs.receive(part_of(log, kOne, 0, 200)));
  EXPECT_EQ(error_of(logs, part_of(other, kOne, 0, 300)), "forked_log");
  EXPECT_EQ(error_of(logs, part_of(other, kOne, 100, 300)), "forked_log");
  EXPECT_EQ(logs.length(kOne), 200u);
  EXPECT_TRUE(std::ranges::equal(logs.bytes({kOne, 0, 500}), std::span(log).first(200)));
  // A forgery behind a gap does not keep the right bytes away for ever.
  ASSERT_TRUE(logs.receive(part_of(other, kOne, 300, 400)));
  EXPECT_EQ(error_of(logs, part_of(log, kOne, 200, 350)), "forked_log");
  EXPECT_EQ(error_of(logs, part_of(log, kOne, 200, log.size())), "none");
  EXPECT_EQ(held(logs, kOne), log);
}

TEST(OperationLogs, NobodyElseAddsToTheOwnLog) {
  const auto log = log_of(kOne, 20, 5);
  OperationLogs logs(kOne);
  EXPECT_EQ(error_of(logs, part_of(log, kOne, 0, 200)), "own_log");
  const auto restored = logs.restore(whole(log, kOne));
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->size(), 20u);
  EXPECT_EQ(error_of(logs, part_of(log, kOne, 100, 200)), "none");
  const LogLength more{kOne, 1'000'000};
  EXPECT_TRUE(logs.missing({&more, 1}).empty());
  EXPECT_TRUE(logs.append(OperationMaker(1).operation({kOne, 21})));
}

TEST(OperationLogs, AStoreThatCutsAnOperation) {
  const auto log = log_of(kOne, 20, 5);
  OperationLogs logs(kOne);
  ASSERT_TRUE(logs.restore(part_of(log, kOne, 0, log.size() - 1)));
  const auto appended = logs.append(OperationMaker(1).operation({kOne, 20}));
  ASSERT_FALSE(appended);
  EXPECT_STREQ(appended.error(), "log_cut_short");
}

struct Wrong {
  const char* name;
  std::vector<Operation> log;
  std::size_t readable;
  const char* error;
};
class Unreadable : public testing::TestWithParam<Wrong> {};
TEST_P(Unreadable, IsSaidByName) {
  std::vector<std::byte> log;
  for (const Operation& o : GetParam().log) {
    const auto bytes = encode(o);
    log.insert(log.end(), bytes.begin(), bytes.end());
  }
  // At once, and byte by byte from the last one on.
  for (const std::size_t step : {log.size(), std::size_t{1}}) {
    OperationLogs logs;
    std::size_t out = 0;
    for (std::size_t end = log.size(); end > 0; end -= std::min(end, step)) {
      const auto taken = logs.receive(part_of(log, kOne, end - std::min(end, step), end));
      if (taken) out += taken->size();
    }
    EXPECT_EQ(out, GetParam().readable);
    ASSERT_NE(logs.unreadable(kOne), nullptr);
    EXPECT_STREQ(logs.unreadable(kOne), GetParam().error);
    EXPECT_EQ(logs.last(kOne).number, GetParam().readable);
    EXPECT_EQ(error_of(logs, whole(log, kOne)), GetParam().error);
    EXPECT_EQ(logs.ahead_bytes(), 0u);
    const LogLength more{kOne, 1'000'000};
    EXPECT_TRUE(logs.missing({&more, 1}).empty()) << "nobody asks for what cannot be read";
  }
}
Operation removal(std::uint32_t number, std::int64_t stamp, std::uint32_t origin = 0) {
  return {{kOne, number}, SimTime{Duration{stamp}}, RemoveObject{ObjectId{5, origin}}};
}
INSTANTIATE_TEST_SUITE_P(
    Table, Unreadable,
    testing::Values(
        Wrong{"FirstIsTwo", {removal(2, 1)}, 0, "operation_number"},
        Wrong{"ANumberTwice", {removal(1, 1), removal(1, 2)}, 1, "operation_number"},
        Wrong{"ANumberLeftOut", {removal(1, 1), removal(2, 2), removal(4, 3)}, 2, "operation_number"},
        Wrong{"AStampTwice", {removal(1, 1), removal(2, 1)}, 1, "operation_stamp"},
        Wrong{"AStampBack", {removal(1, 5), removal(2, 4)}, 1, "operation_stamp"},
        Wrong{"AnIdBeyondAll", {removal(1, 1), removal(2, 2, 0x8000'0000U), removal(3, 3)}, 1, "operation_id"}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(OperationLogs, WhatWaitsBehindAGapIsLimited) {
  OperationLogs logs;
  const std::vector<std::byte> bytes(1000, std::byte{1});
  std::string error = "none";
  std::size_t taken = 0;
  for (std::uint64_t i = 0; error == "none" && i < 100'000; ++i) {
    error = error_of(logs, {kOne, 1 + 2000 * i, bytes});
    if (error == "none") ++taken;
  }
  EXPECT_EQ(error, "operations_ahead");
  EXPECT_LE(logs.ahead_bytes(), OperationLogs::kAheadOfOneMax_bytes);
  EXPECT_GE(taken, OperationLogs::kAheadOfOneMax_bytes / (1000 + OperationLogs::kAheadRun_bytes) - 1);
  // One byte each costs more than a byte; and all authors share a limit.
  for (std::uint32_t author = 10; author < 25; ++author) {
    for (std::uint64_t i = 1; i < 40'000; ++i) {
      if (error_of(logs, {AuthorId{author}, 2 * i, {std::byte{1}}}) != "none") break;
    }
  }
  EXPECT_LE(logs.ahead_bytes(), OperationLogs::kAheadMax_bytes);
  // The logs themselves still grow.
  const auto log = log_of(AuthorId{1000}, 10, 1);
  EXPECT_EQ(error_of(logs, whole(log, AuthorId{1000})), "none");
}

// Bytes of anybody: no crash, and what is held stays what it was.
TEST(OperationLogs, NoiseIsNoHarm) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    OperationMaker make(seed);
    const auto log = log_of(kOne, 10, seed);
    OperationLogs logs(kTwo);
    ASSERT_TRUE(logs.append(make.operation({kTwo, 1})));
    const auto own = held(logs, kTwo);
    for (int i = 0; i < 100; ++i) {
      const std::size_t from = make.random() % log.size(), to = from + 1 + make.random() % (log.size() - from);
      OperationPart part = part_of(log, make.random() % 4 == 0 ? kTwo : kOne, from, to);
      if (make.random() % 3 == 0) part.bytes[make.random() % part.bytes.size()] ^= std::byte{0x11};
      const auto before = held(logs, kOne);
      (void)logs.receive(part);
      const auto after = held(logs, kOne);
      const std::size_t kept = std::min(before.size(), after.size());
      ASSERT_TRUE(std::equal(after.begin(), after.begin() + static_cast<std::ptrdiff_t>(kept), before.begin()));
    }
    EXPECT_EQ(held(logs, kTwo), own);
  }
}

}  // namespace peerd::replication::operation_log_test
