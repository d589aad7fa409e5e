// The daemon's own store on a simulated disk that fails at every write.
#include "peerd/chaos/host_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace peerd::chaos::host_store_test {

using namespace replication;

constexpr std::uint64_t kGenesis = 7;
constexpr AuthorId kAuthor{5};
constexpr HostTime kNow{std::chrono::seconds(1)};

// Appends operations to a log, as a peer does, and has the store write each one.
class Writer {
 public:
  explicit Writer(HostStore& store) : store_(store) {}

  // The number of operations that the store has said to have; begins where the opened store ends.
  std::uint32_t write(const HostStore::Opened& opened, std::uint32_t operations) {
    OperationLogs logs(opened.author);
    for (const OperationPart& part : opened.log) EXPECT_TRUE(logs.restore(part));
    store_.keep(logs);
    std::uint32_t stored = logs.last(opened.author).number;
    for (std::uint32_t i = 0; i < operations && !store_.disk().is_dead(); ++i) {
      const std::uint64_t from = logs.length(opened.author);
      const std::uint32_t number = logs.last(opened.author).number + 1;
      const Operation operation = message(opened.author, number);
      EXPECT_TRUE(logs.append(operation));
      store_.add({{opened.author, from, logs.length(opened.author)}, operation.id}, kNow);
      const auto written = store_.write(kNow);
      if (written.own) stored = written.own->number;
      EXPECT_TRUE(written.own || written.error);
    }
    return stored;
  }

 private:
  static Operation message(AuthorId author, std::uint32_t number) {
    Operation operation;
    operation.id = {author, number};
    operation.stamp = SimTime{std::chrono::milliseconds(number)};
    operation.body =
        SendMessage{PeerId{1}, "topic", "text " + std::to_string(number) + std::string(number * 37U % 900U, '.')};
    return operation;
  }

  HostStore& store_;
};

std::uint32_t operations_of(const HostStore::Opened& opened) {
  OperationLogs logs;
  for (const OperationPart& part : opened.log) EXPECT_TRUE(logs.restore(part));
  return logs.last(kAuthor).number;
}

TEST(HostStore, HasWhatItHasSaidToHaveAfterAnEndAtEveryWrite) {
  for (const bool power_is_cut : {false, true}) {
    std::uint64_t write = 1;
    for (bool died = true; died; ++write) {
      HostStore store(Random(write, power_is_cut ? 1 : 0), "p1");
      store.disk().die_at_write(write);
      auto opened = store.open(kGenesis, kAuthor);
      std::uint32_t stored = 0;
      if (opened) stored = Writer(store).write(*opened, 40);
      if (!store.disk().is_dead()) store.close();
      died = store.disk().is_dead();
      if (died) store.crash(power_is_cut);
      store.disk().die_at_write(std::nullopt);
      const auto again = store.open(kGenesis, kAuthor);
      ASSERT_TRUE(again) << "write " << write << ": " << again.error().text;
      EXPECT_FALSE(again->lost) << "write " << write;
      EXPECT_GE(operations_of(*again), stored) << "write " << write;
      EXPECT_LE(operations_of(*again), stored + 1) << "write " << write;
      store.close();
    }
    EXPECT_GT(write, 100u) << "a store makes so many writes";
  }
}

TEST(HostStore, AFullDiskIsAnErrorAndTheStoreGoesOnAfterwards) {
  HostStore store(Random(1, 0), "p1");
  auto opened = store.open(kGenesis, kAuthor);
  ASSERT_TRUE(opened);
  EXPECT_EQ(Writer(store).write(*opened, 3), 3u);
  store.close();
  store.disk().set_room(0);
  opened = store.open(kGenesis, kAuthor);
  ASSERT_TRUE(opened) << opened.error().text;
  EXPECT_EQ(Writer(store).write(*opened, 100), 3u) << "nothing more fits";
  store.crash(false);
  store.disk().set_room(std::nullopt);
  opened = store.open(kGenesis, AuthorId{6});
  ASSERT_TRUE(opened) << opened.error().text;
  EXPECT_EQ(opened->author, AuthorId{6}) << "what the author has published, the store may lack";
  EXPECT_EQ(operations_of(*opened), 3u);
  EXPECT_EQ(Writer(store).write(*opened, 2), 2u);
}

}  // namespace peerd::chaos::host_store_test
