#include "peerd/peer/store/part_packer.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <span>
#include <string>

#include "peerd/input/compression.hpp"
#include "peerd/peer/store/part_row.hpp"
#include "tests/peerd/peer/store/open_database.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::store::part_packer_test {

using replication::AuthorId;

constexpr AuthorId kOne{3}, kTwo{9};

class Packer : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* const sql :
         {"CREATE TABLE parts (author INTEGER NOT NULL, start INTEGER NOT NULL, checksum INTEGER "
          "NOT NULL, bytes BLOB NOT NULL, PRIMARY KEY (author, start))",
          PartPacker::table()}) {
      ASSERT_TRUE(database.run(sql));
    }
  }
  // A part of so many bytes is in the table, and the packer knows.
  void write(AuthorId author, std::size_t size) {
    std::string& log = logs[author];
    const std::uint64_t from = log.size();
    for (std::size_t i = 0; i < size; ++i) log += static_cast<char>(random() % 4 == 0 ? random() : i);
    const auto bytes = std::as_bytes(std::span(log).subspan(from));
    auto insert = database.prepare("INSERT INTO parts VALUES (?, ?, ?, ?)").value();
    insert.bind(0, std::int64_t{author.value});
    insert.bind(1, static_cast<std::int64_t>(from));
    insert.bind(2, part_checksum(author, from, bytes));
    insert.bind(3, bytes);
    ASSERT_TRUE(insert.step());
    packer.note(author, size);
  }
  std::int64_t rows(const std::string& table) { return database.number("SELECT COUNT(*) FROM " + table).value(); }
  // The log by its rows.
  std::string log_of(AuthorId author) {
    std::string log;
    for (const char* const sql : {"SELECT bytes, start, size FROM packed WHERE author = ? ORDER BY start",
                                  "SELECT bytes, start, -1 FROM parts WHERE author = ? ORDER BY start"}) {
      auto select = database.prepare(sql).value();
      select.bind(0, std::int64_t{author.value});
      while (select.step().value()) {
        EXPECT_EQ(select.number(1), static_cast<std::int64_t>(log.size()));
        const auto bytes = select.bytes(0);
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        const auto size = select.number(2);
        log += size < 0 ? text : decompress(text, static_cast<std::size_t>(size)).value();
      }
    }
    return log;
  }

  testing_support::ScratchFolder folder;
  Database database = testing_support::open_database(folder / "x.sqlite", true).value();
  PartPacker packer;
  std::map<AuthorId, std::string> logs;
  std::mt19937_64 random{1};
};

TEST_F(Packer, MakesOneRowOfManyParts) {
  while (!packer.is_due()) write(kOne, 1000);
  write(kTwo, 5000);
  EXPECT_GE(logs[kOne].size(), PartPacker::kPacked_bytes);
  ASSERT_TRUE(packer.pack(database));
  EXPECT_FALSE(packer.is_due());
  EXPECT_EQ(rows("packed"), 1);
  EXPECT_EQ(rows("parts"), 1) << "of a log that is short";
  for (const AuthorId author : {kOne, kTwo}) EXPECT_EQ(log_of(author), logs[author]);
}

TEST_F(Packer, ManyTimesAndPartsOfAnySize) {
  for (int i = 0; i < 300; ++i) {
    write(random() % 2 == 0 ? kOne : kTwo, 1 + random() % (random() % 20 == 0 ? 200'000 : 3000));
    if (packer.is_due() && random() % 3 == 0) {
      ASSERT_TRUE(packer.pack(database));
    }
    if (i % 50 != 0) continue;
    for (const AuthorId author : {kOne, kTwo}) EXPECT_EQ(log_of(author), logs[author]);
  }
  if (packer.is_due()) {
    ASSERT_TRUE(packer.pack(database));
  }
  for (const AuthorId author : {kOne, kTwo}) EXPECT_EQ(log_of(author), logs[author]);
  EXPECT_GT(rows("packed"), 5);
  EXPECT_LT(rows("parts"), 200);
}

TEST_F(Packer, WhatFailsIsDueAgainWithMore) {
  while (!packer.is_due()) write(kOne, 1000);
  ASSERT_TRUE(database.run("ALTER TABLE packed RENAME TO elsewhere"));
  EXPECT_FALSE(packer.pack(database));
  EXPECT_FALSE(packer.is_due());
  EXPECT_EQ(rows("parts"), static_cast<std::int64_t>(logs[kOne].size() / 1000));
  ASSERT_TRUE(database.run("ALTER TABLE elsewhere RENAME TO packed"));
  while (!packer.is_due()) write(kOne, 1000);
  EXPECT_GE(logs[kOne].size(), 2 * PartPacker::kPacked_bytes);
  ASSERT_TRUE(packer.pack(database));
  EXPECT_EQ(log_of(kOne), logs[kOne]);
}

TEST_F(Packer, GivesRoomBack) {
  for (int i = 0; i < 3000; ++i) write(kOne, 500);
  const std::int64_t before = database.number("PRAGMA page_count").value();
  ASSERT_TRUE(packer.pack(database));
  ASSERT_TRUE(database.run("DELETE FROM packed"));
  ASSERT_TRUE(PartPacker::shrink(database));
  EXPECT_LT(database.number("PRAGMA page_count").value(), before / 10);
  const std::int64_t small = database.number("PRAGMA page_count").value();
  ASSERT_TRUE(PartPacker::shrink(database));
  EXPECT_EQ(database.number("PRAGMA page_count").value(), small) << "there is nothing to give back";
}

}  // namespace peerd::store::part_packer_test
