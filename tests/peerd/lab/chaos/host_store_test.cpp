// The daemon's own store on a simulated disk that fails at every write.
#include "peerd/lab/chaos/host_store.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>

#include "peerd/peer/store/part_row.hpp"
#include "tests/must.hpp"

namespace peerd::chaos::host_store_test {

using namespace replication;

constexpr std::uint64_t kGenesis = 7;
constexpr AuthorId kAuthor{5};
constexpr HostTime kNow{std::chrono::seconds(1)};

// Appends operations to a log, as a peer does, and has the store write each one.
class Writer {
 public:
  explicit Writer(HostStore& store, std::size_t more_bytes = 0) : store_(store), more_bytes_(more_bytes) {}

  // The number of operations that the store has said to have; begins where the opened store ends.
  std::uint32_t write(const HostStore::Opened& opened, std::uint32_t operations) {
    OperationLogs logs(opened.author);
    for (const OperationPart& part : opened.log) EXPECT_TRUE(logs.restore(part));
    store_.keep(logs);
    std::uint32_t stored = logs.last(opened.author).number;
    for (std::uint32_t i = 0; i < operations && !store_.disk().is_dead(); ++i) {
      const std::uint64_t from = logs.length(opened.author);
      const std::uint32_t number = logs.last(opened.author).number + 1;
      const Operation operation = message(opened.author, number, more_bytes_);
      EXPECT_TRUE(logs.append(operation));
      store_.add({{opened.author, from, logs.length(opened.author)}, operation.id}, kNow);
      const auto written = store_.write(kNow);
      if (written.own) stored = written.own->number;
      EXPECT_TRUE(written.own || written.error);
    }
    return stored;
  }

 private:
  static Operation message(AuthorId author, std::uint32_t number, std::size_t more_bytes) {
    return {.id = {author, number},
            .stamp = SimTime{std::chrono::milliseconds(number)},
            .body = SendMessage{PeerId{1}, "topic",
                                "text " + std::to_string(number) + std::string(number * 37U % 900U + more_bytes, '.')}};
  }

  HostStore& store_;
  std::size_t more_bytes_;  // of each operation
};

std::uint32_t operations_of(const HostStore::Opened& opened) {
  OperationLogs logs;
  for (const OperationPart& part : opened.log) EXPECT_TRUE(logs.restore(part));
  return logs.last(kAuthor).number;
}

// `use` opens the store and has it write; it returns how many operations the store has said to have. The disk dies at
// the first write of that, then at the second one, and so on until none of them is the last one. Each time the store
// has afterwards what it has said to have, and at most one operation more. Returns how many writes there were.
std::uint64_t survive_each_write(const std::function<std::uint32_t(HostStore&, std::uint64_t dies_at_write)>& use,
                                 bool power_is_cut) {
  std::uint64_t write = 1;
  for (bool died = true; died; ++write) {
    SCOPED_TRACE(testing::Message() << "write " << write << (power_is_cut ? ", a power cut" : ""));
    HostStore store(Random(write, power_is_cut ? 1 : 0), "p1");
    const std::uint32_t stored = use(store, write);
    if (!store.disk().is_dead()) store.close();
    died = store.disk().is_dead();
    if (died) store.crash(power_is_cut);
    store.disk().die_at_write(std::nullopt);
    const auto again = store.open(kGenesis, kAuthor);
    if (!again) {
      ADD_FAILURE() << again.error().text;
      return write;
    }
    EXPECT_FALSE(again->lost);
    EXPECT_GE(operations_of(*again), stored);
    EXPECT_LE(operations_of(*again), stored + 1);
    store.close();
  }
  return write;
}

TEST(HostStore, HasWhatItHasSaidToHaveAfterAnEndAtEveryWrite) {
  const auto use = [](HostStore& store, std::uint64_t dies_at_write) {
    store.disk().die_at_write(dies_at_write);
    const auto opened = store.open(kGenesis, kAuthor);
    return opened ? Writer(store).write(*opened, 40) : 0;
  };
  for (const bool power_is_cut : {false, true}) EXPECT_GT(survive_each_write(use, power_is_cut), 100u);
}

// So does a store that packs what it has while it ends.
TEST(HostStore, HasWhatItHasSaidToHaveAfterAnEndWhileItPacks) {
  const auto use = [](HostStore& store, std::uint64_t dies_at_write) {
    EXPECT_EQ(Writer(store, 8000).write(store.open(kGenesis, kAuthor).value(), 7), 7u) << "which are not packed yet";
    store.close();
    const auto opened = store.open(kGenesis, kAuthor);
    store.disk().die_at_write(dies_at_write);
    return Writer(store, 8000).write(opened.value(), 9);  // two rows are packed meanwhile
  };
  for (const bool power_is_cut : {false, true}) EXPECT_GT(survive_each_write(use, power_is_cut), 60u);
}

TEST(HostStore, AStoreOfTheFormatBeforeHasAllAfterAnEndAtEveryWrite) {
  for (const bool power_is_cut : {false, true}) {
    std::uint64_t write = 1;
    for (bool died = true; died; ++write) {
      SimulatedDisk disk(Random(write, power_is_cut ? 1 : 0));
      SimulatedFileSystem files(disk);
      const auto open = [&] {
        return store::OperationStore::open(std::make_unique<SimulatedFolder>(files, "p1"), kGenesis, {kAuthor});
      };
      ASSERT_TRUE(open());
      std::uint64_t size = 0;
      {
        SimulatedFolder folder(files, "p1");
        auto database = must(store::Database::open(folder, "operations.sqlite", false));
        ASSERT_TRUE(database.accept());
        for (const char* const sql : {"DROP TABLE packed", "PRAGMA user_version = 1", "BEGIN"}) {
          ASSERT_TRUE(database.run(sql));
        }
        auto insert = must(database.prepare("INSERT INTO parts VALUES (?, ?, ?, ?)"));
        for (std::uint32_t number = 1; number <= 300; ++number) {
          const auto bytes = encode({{kAuthor, number},
                                     SimTime{std::chrono::milliseconds(number)},
                                     SendMessage{PeerId{1}, "topic", std::string(1000, '.')}});
          insert.bind(0, std::int64_t{kAuthor.value});
          insert.bind(1, static_cast<std::int64_t>(size));
          insert.bind(2, store::part_checksum(kAuthor, size, bytes));
          insert.bind(3, bytes);
          ASSERT_TRUE(insert.step());
          size += bytes.size();
        }
        ASSERT_TRUE(database.run("COMMIT"));
      }
      disk.die_at_write(write);
      (void)open();
      died = disk.is_dead();
      if (died) disk.revive(power_is_cut);
      disk.die_at_write(std::nullopt);
      const auto again = open();
      ASSERT_TRUE(again) << "write " << write << ": " << again.error().text;
      ASSERT_EQ((*again)->logs().size(), 1u) << "write " << write;
      EXPECT_EQ((*again)->logs()[0].bytes, size) << "write " << write;
      EXPECT_EQ((*again)->logs()[0].operations, 300u) << "write " << write;
      EXPECT_EQ((*again)->packing_error(), "");
    }
    EXPECT_GT(write, 30u) << "packing makes so many writes";
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
