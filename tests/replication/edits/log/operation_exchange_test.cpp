#include "replication/edits/log/operation_exchange.hpp"

#include <gtest/gtest.h>

#include "tests/replication/edits/log/holders.hpp"

namespace peerd::replication::operation_exchange_test {

using namespace std::chrono_literals;
using test::author;
using test::Holders;
using test::log_of;
using test::OperationMaker;
using test::peer;
using test::Weather;

Weather losing(double loss) { return {.loss = loss}; }

TEST(OperationExchange, AloneItSendsNothing) {
  Holders holders(1, losing(0), 1);
  for (std::uint32_t n = 1; n <= 5; ++n) holders.append(0, OperationMaker(n).operation({author(0), n}));
  holders.run(5s);
  EXPECT_EQ(holders.messages(), 0u);
  EXPECT_FALSE(holders.exchange(0).next_deadline());
}

TEST(OperationExchange, ANewOperationGoesOutOnceAndIsHeldByOthers) {
  Holders holders(4, losing(0), 1);
  const Operation o = OperationMaker(1).operation({author(2), 1});
  holders.append(2, o);
  holders.run(10ms);
  EXPECT_TRUE(holders.all_equal());
  EXPECT_EQ(holders.messages(), 1u);
  EXPECT_EQ(holders.part_bytes(), encode(o).size());
  ASSERT_EQ(holders.operations(0).size(), 1u);
  EXPECT_TRUE(test::same(holders.operations(0)[0], o));
  EXPECT_TRUE(holders.exchange(2).newly_held().empty()) << "nobody has said so yet";
  EXPECT_TRUE(holders.exchange(0).has_news());
  holders.run(300ms);
  EXPECT_EQ(holders.exchange(2).newly_held(), (std::vector<OperationId>{{author(2), 1}}));
  EXPECT_TRUE(holders.exchange(2).newly_held().empty());
  EXPECT_FALSE(holders.exchange(0).has_news());
  holders.run(10s);
  EXPECT_EQ(holders.messages(), 1u);
}

TEST(OperationExchange, OperationsOfOneInstantShareADatagram) {
  Holders holders(2, losing(0), 1);
  for (std::uint32_t n = 1; n <= 3; ++n) {
    holders.append(0, {{author(0), n}, SimTime{Duration{n}}, RemoveObject{ObjectId{n}}});
  }
  holders.run(100ms);
  EXPECT_EQ(holders.messages(), 1u);
  EXPECT_TRUE(holders.all_equal());
}

// Loss, copies, reordering; everybody writes, some begin late: all logs are equal in the end, everything has come out
// once and in order, and then nothing is sent any more.
class Exchange : public testing::TestWithParam<double> {};
TEST_P(Exchange, EndsWithEqualLogs) {
  double copies = 0.0, seconds = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Weather weather{.latency = 5ms, .jitter = 20ms, .loss = GetParam(), .duplicates = 0.1};
    Holders holders(6, weather, seed);
    OperationMaker make(seed);
    std::vector<std::uint32_t> numbers(8, 0);
    std::uint64_t written = 0;
    for (int i = 0; i < 200; ++i) {
      const std::size_t who = make.random() % numbers.size();
      if (i == 100 || i == 150) holders.add();
      if (who < 6 || (who == 6 && i >= 100)) {
        const OperationId id{author(who), ++numbers[who]};
        const Operation o = make.random() % 20 == 0 ? make.large(id, make.random() % 20'000 + 1) : make.operation(id);
        written += encode(o).size();
        holders.append(who, o);
      }
      holders.run(Duration{20ms} * (make.random() % 3));
    }
    seconds += to_seconds(holders.run_until_equal(60s));
    ASSERT_TRUE(holders.all_equal());
    for (std::size_t i = 0; i < 8; ++i) {
      std::map<AuthorId, std::uint32_t> last;
      for (const Operation& o : holders.operations(i)) ASSERT_EQ(o.id.number, ++last[o.id.author]);
      for (std::size_t k = 0; k < 8; ++k) {
        if (k == i) continue;
        ASSERT_EQ(last[author(k)], numbers[k]);
      }
    }
    holders.run(5s);  // what was asked for before comes to an end
    const std::uint64_t messages = holders.messages();
    holders.run(30s);
    EXPECT_EQ(holders.messages(), messages) << "nobody lacks anything";
    copies += static_cast<double>(holders.part_bytes()) / static_cast<double>(written);
  }
  std::printf("%.0f %% lost: sent %.2f times, equal %.2f s after the last operation\n", 100 * GetParam(), copies / 8,
              seconds / 8);
  EXPECT_LT(copies / 8, 12.0);
}
INSTANTIATE_TEST_SUITE_P(Loss, Exchange, testing::Values(0.0, 0.01, 0.1, 0.3, 0.5),
                         [](const auto& of) { return "Permille" + std::to_string(int(1000 * of.param)); });

// The range goes out three times at most, in the mean of the seeds, whoever holds it: its author alone, or one peer
// without it, or many.
double copies_to_16(std::size_t holding, bool with_author, std::uint64_t seed, Duration latency) {
  Holders holders(holding + 16, {.latency = latency, .jitter = latency / 2}, seed);
  const AuthorId of = with_author ? author(0) : AuthorId{7};
  const auto log = log_of(of, 200, seed);
  for (std::size_t i = 0; i < holding; ++i) holders.give(i, of, log);
  holders.run_until_equal(60s);
  EXPECT_TRUE(holders.all_equal());
  holders.run(2s);
  return static_cast<double>(holders.part_bytes()) / static_cast<double>(log.size());
}
TEST(OperationExchange, SixteenThatLackTheSameGetItThreeTimesAtMost) {
  for (const Duration latency : {2ms, 100ms}) {
    for (const std::size_t holding : {1, 2, 16}) {
      for (const bool with_author : {true, false}) {
        double sum = 0.0;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) sum += copies_to_16(holding, with_author, seed, latency);
        std::printf("%zu hold it, latency %.0f ms, %s: %.2f copies\n", holding, 1e3 * to_seconds(latency),
                    with_author ? "the author among them" : "without the author", sum / 5);
        EXPECT_LE(sum / 5, 3.0);
        EXPECT_GE(sum / 5, 1.0);
      }
    }
  }
}

// A long log comes whole and at the rate that its holders send, window by window.
TEST(OperationExchange, ANewcomerGetsALongLog) {
  for (const double loss : {0.0, 0.05}) {
    Holders holders(3, losing(loss), 1);
    std::vector<std::byte> log;
    OperationMaker make(1);
    for (std::uint32_t n = 1; log.size() < 5'000'000; ++n) {
      const auto bytes = encode(make.large({AuthorId{7}, n}, n == 3 ? kOperationMax_bytes - 100 : 500));
      log.insert(log.end(), bytes.begin(), bytes.end());
    }
    for (std::size_t i = 0; i < 3; ++i) holders.give(i, AuthorId{7}, log);
    holders.add();
    const Duration time = holders.run_until_equal(60s);
    EXPECT_TRUE(holders.all_equal());
    std::printf("%.0f %% lost: 5 MB in %.2f s, sent %.2f times\n", 100 * loss, to_seconds(time),
                static_cast<double>(holders.part_bytes()) / static_cast<double>(log.size()));
    EXPECT_LT(holders.part_bytes(), 2 * log.size());
  }
}

TEST(OperationExchange, HoldersRepairWhatADepartedAuthorSent) {
  Holders holders(5, losing(0), 3);
  const auto log = log_of(author(0), 50, 3);
  holders.give(0, author(0), log);
  holders.give(1, author(0), log);
  holders.lose(0);
  holders.run_until_equal(20s);
  EXPECT_TRUE(holders.all_equal());
  EXPECT_EQ(holders.logs(4).length(author(0)), log.size());
}

// A peer asks for bytes that nobody holds ever more seldom, and asks in few datagrams.
TEST(OperationExchange, QuestionsThatNobodyAnswersBecomeRare) {
  OperationLogs logs(author(0));
  OperationExchange exchange(logs, peer(0), author(0), 1);
  HostTime now{1s};
  std::vector<LogLength> lies;
  for (std::uint32_t i = 0; i < kLogLengthsMax; ++i) lies.push_back({AuthorId{1000 + i}, kLogMax_bytes});
  std::size_t datagrams = 0, ranges = 0;
  for (int i = 0; i < 600; ++i, now += 100ms) {
    exchange.on_lengths(now, peer(1), lies);
    for (const OperationMessage& m : exchange.on_tick(now)) {
      ++datagrams;
      ranges += m.operation_requests.size();
      EXPECT_LE(m.operation_requests.size(), kOperationRangesMax);
      EXPECT_TRUE(m.operations.empty());
    }
  }
  EXPECT_LE(ranges, kLogLengthsMax * (60 / 2 + 10));
  EXPECT_LE(datagrams, 60 / 2 * 20 + 100u);
  exchange.on_lost(peer(1));
  EXPECT_TRUE(exchange.on_tick(now + 10s).empty());
}

// A storm of questions costs no more than the rate.
TEST(OperationExchange, AStormOfQuestionsIsBounded) {
  OperationLogs logs(author(0));
  OperationExchange exchange(logs, peer(0), author(0), 1, {.bytes_per_s = 100'000, .burst_bytes = 20'000});
  HostTime now{1s};
  std::uint32_t n = 0;
  while (logs.length(author(0)) < 1'000'000) {
    ASSERT_TRUE(logs.append(OperationMaker(1).large({author(0), ++n}, 50'000)));
    exchange.on_append(now, {author(0), n});
  }
  std::size_t bytes = 0;
  std::mt19937_64 random(1);
  for (int i = 0; i < 600; ++i, now += 16ms) {
    for (std::uint32_t k = 0; k < 50; ++k) {
      std::vector<OperationRange> ask;
      for (std::size_t r = 0; r < kOperationRangesMax; ++r) {
        const std::uint64_t from = random() % 1'000'000;
        ask.push_back({author(0), from, from + 1 + random() % 100'000});
      }
      exchange.on_requests(now, peer(k + 1), ask);
    }
    for (const OperationMessage& m : exchange.on_tick(now)) {
      for (const OperationPart& part : m.operations) bytes += part.bytes.size();
    }
    ASSERT_TRUE(!exchange.next_deadline() || *exchange.next_deadline() < now + 1s);
  }
  EXPECT_LE(bytes, 100'000u * 10 + 20'000 + 2000);
}

TEST(OperationExchange, LengthsTakeTurnsInHellos) {
  OperationLogs logs;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto log = log_of(author(i), 1, i);
    ASSERT_TRUE(logs.restore({author(i), 0, log}));
  }
  OperationExchange exchange(logs, peer(0), kNoAuthor, 1);
  EXPECT_TRUE(exchange.has_news());
  std::map<AuthorId, int> seen;
  for (int hello = 0; hello < 20; ++hello) {
    const auto some = exchange.lengths_for_hello(63);
    EXPECT_TRUE(std::ranges::is_sorted(some));
    EXPECT_LE(packed(some).size() + 2, 63u);
    for (const LogLength& log : some) ++seen[log.author];
  }
  EXPECT_FALSE(exchange.has_news());
  EXPECT_EQ(seen.size(), 100u);
  for (const auto& [of, times] : seen) EXPECT_GE(times, 2) << of.value;
  EXPECT_TRUE(exchange.lengths_for_hello(0).empty());
  EXPECT_EQ(exchange.lengths_for_hello(1000).size(), 100u);
}

}  // namespace peerd::replication::operation_exchange_test
