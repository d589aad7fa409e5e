// The store of operations: what is in it is there again, or the store says what is wrong with it.
#include "peerd/peer/store/operation_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <csignal>
#include <map>
#include <thread>

#include "peerd/peer/store/part_row.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "tests/must.hpp"
#include "tests/peerd/peer/store/open_database.hpp"
#include "tests/peerd/peer/store/watched_fsync.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/replication/peer/operations.hpp"

namespace peerd::store::operation_store_test {

using replication::AuthorId;
using replication::OperationPart;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing_support::ScratchFolder;

constexpr std::uint64_t kWorld = 0xFEED'0000'C0FF'EE01;
constexpr AuthorId kOwn{7}, kOther{99};

class Store : public testing::Test {
 protected:
  Result<std::unique_ptr<OperationStore>> open(std::uint64_t world = kWorld) {
    return OperationStore::open(at, world, {kOwn});
  }
  // So many more operations of the author, as one part.
  OperationPart part(AuthorId author, std::uint32_t count) {
    Log& log = logs[author];
    OperationPart part{author, log.bytes, {}};
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto bytes = replication::encode(maker.operation({author, ++log.number}));
      part.bytes.insert(part.bytes.end(), bytes.begin(), bytes.end());
    }
    log.bytes += part.bytes.size();
    return part;
  }
  static void append(OperationStore& store, std::vector<OperationPart> parts) { must(store.append(parts)); }
  // Opens the store for that alone.
  void keep(std::vector<OperationPart> parts) {
    const auto store = must(open());
    append(*store, std::move(parts));
  }
  // As on a full disk: files cannot grow.
  static Result<void> append_on_full_disk(OperationStore& store, const OperationPart& more) {
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{8192, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &none);
    auto done = store.append({&more, 1});
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    return done;
  }
  [[nodiscard]] std::string error_of_opening(std::uint64_t world = kWorld) {
    const auto store = open(world);
    return store ? "" : store.error().text;
  }
  // The bytes of each log.
  static std::map<AuthorId, std::vector<std::byte>> bytes_of(const std::vector<OperationPart>& parts) {
    std::map<AuthorId, std::vector<std::byte>> all;
    for (const OperationPart& p : parts) all[p.author].insert(all[p.author].end(), p.bytes.begin(), p.bytes.end());
    return all;
  }

  struct Log {
    std::uint64_t bytes = 0;
    std::uint32_t number = 0;
  };
  ScratchFolder folder;
  std::filesystem::path at = folder / "store";
  replication::test::OperationMaker maker{1};
  std::map<AuthorId, Log> logs;
};

TEST_F(Store, BeginsEmptyAndKeepsWhatIsAppended) {
  std::vector<OperationPart> all;
  {
    auto store = must(open());
    EXPECT_THAT(store->log(), IsEmpty());
    EXPECT_EQ(store->author(), kOwn);
    all = {part(kOwn, 3), part(kOther, 1)};
    append(*store, all);
    all.push_back(part(kOwn, 2));
    append(*store, {all.back()});
  }
  const auto again = must(OperationStore::open(at, kWorld, {AuthorId{1234}}));
  EXPECT_EQ(again->author(), kOwn) << "the author that the store began with";
  EXPECT_EQ(bytes_of(again->log()), bytes_of(all));
  ASSERT_THAT(again->logs(), SizeIs(2));
  EXPECT_EQ(again->logs()[0].operations, 5U);
  EXPECT_EQ(again->logs()[0].bytes, logs[kOwn].bytes);
  EXPECT_EQ(again->logs()[1].operations, 1U);
}

// Parts that the store got one by one become a few packed rows, with the same bytes.
TEST_F(Store, OldPartsArePacked) {
  const auto rows = [&](const char* table) {
    auto database = testing_support::open_database(at / "operations.sqlite", false);
    return database.value().number(std::string("SELECT COUNT(*) FROM ") + table).value();
  };
  std::vector<OperationPart> all;
  {
    auto store = must(open());
    while (logs[kOwn].bytes < 4 * PartPacker::kPacked_bytes + 4000) {  // a row ends with an operation
      all.push_back(part(kOwn, 1));
      append(*store, {all.back()});
    }
    all.push_back(part(kOther, 2000));  // at once
    append(*store, {all.back()});
    EXPECT_EQ(store->packing_error(), "");
  }
  ASSERT_GT(logs[kOther].bytes, PartPacker::kPacked_bytes);
  EXPECT_EQ(rows("packed"), 4 + 1);
  EXPECT_LT(rows("parts"), 100);
  EXPECT_EQ(bytes_of(must(OperationStore::open(at))->log()), bytes_of(all));
  {
    auto store = must(open());
    EXPECT_EQ(bytes_of(store->log()), bytes_of(all));
    all.push_back(part(kOwn, 3));
    append(*store, {all.back()});
  }
  EXPECT_EQ(bytes_of(must(open())->log()), bytes_of(all));
}

// The file of a store as earlier builds have left it gets shorter.
TEST_F(Store, OneOfTheFormatBeforeIsPacked) {
  ASSERT_TRUE(open());
  const auto file = at / "operations.sqlite";
  OperationPart all{kOwn, 0, {}};
  {
    auto database = must(testing_support::open_database(file, false));
    ASSERT_TRUE(database.accept());
    for (const char* const sql : {"DROP TABLE packed", "PRAGMA user_version = 1", "BEGIN"}) {
      ASSERT_TRUE(database.run(sql));
    }
    auto insert = must(database.prepare("INSERT INTO parts VALUES (?, ?, ?, ?)"));
    for (std::uint32_t number = 1; number <= 10'000; ++number) {
      const auto bytes = replication::encode({{kOwn, number},
                                              SimTime{Duration{number * 20'000'000LL}},
                                              replication::SetField{NodeId{number % 100}, "translation", "1 2 3", 7}});
      insert.bind(0, std::int64_t{kOwn.value});
      insert.bind(1, static_cast<std::int64_t>(all.bytes.size()));
      insert.bind(2, part_checksum(kOwn, all.bytes.size(), bytes));
      insert.bind(3, bytes);
      ASSERT_TRUE(insert.step());
      all.bytes.insert(all.bytes.end(), bytes.begin(), bytes.end());
    }
    ASSERT_TRUE(database.run("COMMIT"));
  }
  const std::string before = testing_support::text_of(file);
  EXPECT_EQ(bytes_of(must(OperationStore::open(at))->log()), bytes_of({all}));
  EXPECT_EQ(testing_support::text_of(file), before) << "it was only read";
  for (int i = 0; i < 2; ++i) {
    const auto store = must(open());
    EXPECT_EQ(bytes_of(store->log()), bytes_of({all}));
    EXPECT_EQ(store->author(), kOwn);
    EXPECT_EQ(store->packing_error(), "");
  }
  EXPECT_LT(std::filesystem::file_size(file), before.size() / 3);
}

TEST_F(Store, AChangedByteOfAPackedRowIsFound) {
  keep({part(kOwn, 2000)});
  const auto file = at / "operations.sqlite";
  std::string text = testing_support::text_of(file);
  const auto frame = text.find("\x28\xB5\x2F\xFD");  // zstd's magic number
  ASSERT_NE(frame, std::string::npos);
  for (const std::size_t byte : {0, 4, 5, 40}) {
    std::string changed = text;
    changed[frame + byte] ^= 1;
    folder.write("store/operations.sqlite", changed);
    EXPECT_THAT(error_of_opening(), HasSubstr("is damaged")) << byte;
  }
}

TEST_F(Store, AnotherWorldIsRefusedByName) {
  const std::vector<OperationPart> all{part(kOwn, 3)};
  keep(all);
  EXPECT_THAT(error_of_opening(kWorld + 1), AllOf(HasSubstr(at.string()), HasSubstr("another world")));
  EXPECT_EQ(bytes_of(must(open())->log()), bytes_of(all)) << "and nothing of it is lost";
}

TEST_F(Store, ASecondUserIsRefused) {
  const auto first = must(open());
  EXPECT_THAT(error_of_opening(), AllOf(HasSubstr(at.string()), HasSubstr("in use by another process")));
}

TEST_F(Store, AnotherFormatIsRefused) {
  ASSERT_TRUE(open());
  {
    auto database = must(testing_support::open_database(at / "operations.sqlite", false));
    ASSERT_TRUE(database.run("PRAGMA user_version = 3"));
  }
  EXPECT_THAT(error_of_opening(), HasSubstr("has format 3"));
}

TEST_F(Store, AFileThatIsEmptyOrAnotherProgramsIsNoStore) {
  std::filesystem::create_directories(at);
  folder.write("store/operations.sqlite", "");
  EXPECT_THAT(error_of_opening(), HasSubstr("is damaged"));
  folder.write("store/operations.sqlite", std::string(8192, 'x'));
  EXPECT_THAT(error_of_opening(), HasSubstr("is damaged"));
  EXPECT_EQ(testing_support::text_of(at / "operations.sqlite"), std::string(8192, 'x')) << "it stays as it is";
}

TEST_F(Store, AnotherProgramsDatabaseIsNoStore) {
  std::filesystem::create_directories(at);
  const auto file = at / "operations.sqlite";
  {
    auto database = must(testing_support::open_database(file, true));
    ASSERT_TRUE(database.run("CREATE TABLE theirs (x)"));
  }
  const std::string before = testing_support::text_of(file);
  EXPECT_THAT(error_of(open()), IsError(2, AllOf(HasSubstr(at.string()), HasSubstr("another program's"))));
  EXPECT_EQ(testing_support::text_of(file), before);
}

TEST_F(Store, AFileThatCannotBeReadIsNotCalledDamaged) {
  std::filesystem::create_directories(at / "operations.sqlite");
  EXPECT_THAT(error_of(OperationStore::open(at)),
              IsError(3, AllOf(HasSubstr(at.string()), HasSubstr("Is a directory"))));
}

// A store whose peer was killed has its last operations in the file that is written ahead. Nothing of the two changes
// when it is refused, or only checked.
TEST_F(Store, WhatIsRefusedOrCheckedStaysAsItIs) {
  const auto killed = folder / "killed";
  std::filesystem::create_directories(killed);
  {
    auto store = must(open());
    append(*store, {part(kOwn, 20)});
    for (const char* const file : {"operations.sqlite", "operations.sqlite-wal", "author"}) {
      std::filesystem::copy_file(at / file, killed / file);
    }
  }
  const auto all = [&] {
    std::map<std::string, std::string> files;
    for (const auto& each : std::filesystem::directory_iterator(killed)) {
      files[each.path().filename()] = testing_support::text_of(each.path());
    }
    return files;
  };
  const auto before = all();
  ASSERT_GT(before.at("operations.sqlite-wal").size(), 4096U);
  EXPECT_THAT(error_of(OperationStore::open(killed, kWorld + 1, {kOwn})).text, HasSubstr("another world"));
  EXPECT_EQ(all(), before);
  EXPECT_THAT(must(OperationStore::open(killed))->log(), SizeIs(1));
  EXPECT_EQ(all(), before);
  {  // a newer format, which is written ahead
    auto database = must(testing_support::open_database(killed / "operations.sqlite", false));
    ASSERT_TRUE(database.run("PRAGMA user_version = 3"));
  }
  const auto newer = all();
  EXPECT_THAT(error_of(OperationStore::open(killed, kWorld, {kOwn})).text, HasSubstr("has format 3"));
  EXPECT_EQ(all(), newer);
}

TEST_F(Store, ACheckOfAStoreThatWasClosedLeavesNoOtherFile) {
  ASSERT_TRUE(open());
  ASSERT_TRUE(OperationStore::open(at));
  EXPECT_FALSE(std::filesystem::exists(at / "operations.sqlite-wal"));
}

TEST_F(Store, AStoreThatIsNotThereIsNotMadeByACheck) {
  EXPECT_THAT(error_of(OperationStore::open(at)).text, HasSubstr("there is no store in"));
  EXPECT_FALSE(std::filesystem::exists(at));
}

// Each file that is cut short at some place is refused, or it is whole.
TEST_F(Store, ATruncatedFileIsRefused) {
  const OperationPart appended = part(kOwn, 40);
  keep({appended});
  const auto file = at / "operations.sqlite";
  const std::string whole = testing_support::text_of(file);
  ASSERT_GT(whole.size(), 8192U);
  std::size_t refused = 0, all = 0;
  for (std::size_t size = 0; size < whole.size(); size += 509, ++all) {
    folder.write("store/operations.sqlite", whole.substr(0, size));
    std::filesystem::remove(at / "operations.sqlite-wal");
    const auto store = OperationStore::open(at);
    if (store) {  // its last page ends with bytes that say nothing
      EXPECT_EQ(bytes_of((*store)->log()), bytes_of({appended})) << size;
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, all / 2);
}

// One byte of what is stored is another one.
TEST_F(Store, AChangedByteOfAPartIsFound) {
  const OperationPart appended = part(kOwn, 1);
  keep({appended});
  const auto file = at / "operations.sqlite";
  std::string text = testing_support::text_of(file);
  const std::string bytes(reinterpret_cast<const char*>(appended.bytes.data()), appended.bytes.size());
  const auto found = text.find(bytes);
  ASSERT_NE(found, std::string::npos);
  text[found + bytes.size() - 1] ^= 1;
  folder.write("store/operations.sqlite", text);
  EXPECT_THAT(error_of_opening(), HasSubstr("is damaged"));
}

// A crash leaves what was written ahead cut at any byte, or with zeros behind: the store has a prefix of the
// transactions.
TEST_F(Store, ALogThatIsWrittenAheadMayEndAnywhere) {
  ASSERT_TRUE(open());
  const auto file = at / "operations.sqlite", wal = at / "operations.sqlite-wal";
  const std::string before = testing_support::text_of(file);
  std::vector<OperationPart> all;
  std::string ahead;
  {
    auto store = must(open());
    for (int i = 0; i < 5; ++i) {
      all.push_back(part(i % 2 == 0 ? kOwn : kOther, 2));
      append(*store, {all.back()});
    }
    ahead = testing_support::text_of(wal);
    ASSERT_EQ(testing_support::text_of(file), before) << "all of it is ahead";
  }
  ASSERT_GT(ahead.size(), 4096U);
  std::vector<std::size_t> sizes{ahead.size()};
  for (std::size_t size = 0; size < ahead.size(); size += 211) sizes.push_back(size);
  std::ranges::sort(sizes);
  for (const bool zeros : {false, true}) {
    std::size_t last = 0;
    for (const std::size_t size : sizes) {
      folder.write("store/operations.sqlite", before);
      std::string cut = ahead.substr(0, size);
      if (zeros) cut.resize(ahead.size());
      folder.write("store/operations.sqlite-wal", cut);
      const auto store = open();
      ASSERT_TRUE(store) << size << ": " << store.error().text;
      const std::size_t held = (*store)->log().size();
      EXPECT_GE(held, last) << size;
      EXPECT_EQ(bytes_of((*store)->log()), bytes_of({all.begin(), all.begin() + static_cast<std::ptrdiff_t>(held)}));
      last = held;
    }
    EXPECT_EQ(last, all.size());
  }
}

// Acknowledged operations stay. After a restart the peer writes as a new author, because the store may lack operations
// that the former author had published while the disk was full.
TEST_F(Store, AFullDiskIsSaidAndLosesNothing) {
  const OperationPart first = part(kOwn, 2), lost = part(kOwn, 200);
  {
    auto store = must(open());
    append(*store, {first});
    EXPECT_THAT(error_of(append_on_full_disk(*store, lost)).text, HasSubstr("cannot be written"));
    EXPECT_FALSE(store->must_stop());
  }
  const auto again = must(OperationStore::open(at, kWorld, {AuthorId{55}}));
  EXPECT_EQ(bytes_of(again->log()), bytes_of({first}));
  EXPECT_EQ(again->author(), AuthorId{55});
}

TEST_F(Store, WhatAFullDiskRefusedCanBeWrittenLater) {
  const OperationPart late = part(kOwn, 200);
  {
    auto store = must(open());
    EXPECT_FALSE(append_on_full_disk(*store, late));
    append(*store, {late});
  }
  const auto again = must(OperationStore::open(at, kWorld, {AuthorId{55}}));
  EXPECT_EQ(bytes_of(again->log()), bytes_of({late}));
  EXPECT_EQ(again->author(), kOwn);
}

// The author of a store that is a copy, or was put back, may have written on elsewhere: its log would fork.
class Copy : public Store {
 protected:
  void SetUp() override { keep({part(kOwn, 2)}); }
  static void expect_author(const std::filesystem::path& where, AuthorId author, bool is_copy) {
    const auto store = must(OperationStore::open(where, kWorld, {AuthorId{55}}));
    EXPECT_EQ(store->author(), author);
    EXPECT_EQ(store->is_copy(), is_copy);
    EXPECT_THAT(store->logs(), Not(IsEmpty())) << "and all that was in it is there";
  }
};

TEST_F(Copy, OfTheFolderBeginsALogOfItsOwn) {
  std::filesystem::copy(at, folder / "copy", std::filesystem::copy_options::recursive);
  expect_author(folder / "copy", AuthorId{55}, true);
  expect_author(folder / "copy", AuthorId{55}, false);
  expect_author(at, kOwn, false);
}

TEST_F(Copy, IsNotWhatHasAnotherName) {
  std::filesystem::rename(at, folder / "moved");
  expect_author(folder / "moved", kOwn, false);
}

TEST_F(Copy, ThatIsPutBackInPlaceBeginsALogOfItsOwn) {
  const std::string file = testing_support::text_of(at / "operations.sqlite");
  const std::string author = testing_support::text_of(at / "author");
  keep({part(kOwn, 1)});
  folder.write("store/operations.sqlite", file);
  folder.write("store/author", author);
  expect_author(at, AuthorId{55}, true);
}

TEST_F(Copy, OfTheFileAloneBeginsALogOfItsOwn) {
  const std::string file = testing_support::text_of(at / "operations.sqlite");
  keep({part(kOwn, 1)});
  ASSERT_TRUE(open());
  folder.write("store/operations.sqlite", file);
  expect_author(at, AuthorId{55}, true);
}

TEST_F(Copy, WhoseAuthorIsNoNumberIsDamaged) {
  folder.write("store/author", "seven\n");
  EXPECT_THAT(error_of_opening(), AllOf(HasSubstr(at.string()), HasSubstr("`author` is not a number")));
}

// A write that the disk does not take is not taken for done.
class Disk : public Store {
 protected:
  testing_support::WatchedFsync fsyncs;
};

TEST_F(Disk, HasTheNamesOfAllFoldersThatLeadToAStore) {
  const auto deep = folder / "a" / "b" / "store";
  ASSERT_TRUE(OperationStore::open(deep, kWorld, {kOwn}));
  EXPECT_THAT(fsyncs.done(), testing::IsSupersetOf({folder.path(), folder / "a", folder / "a" / "b", deep}));
}

// The file `author` may be there although it was not written for good.
TEST_F(Disk, AnAuthorThatIsNotWrittenForGoodGoesWithTheNextFailure) {
  const OperationPart first = part(kOwn, 200), second = part(kOwn, 200);
  {
    auto store = must(open());
    ASSERT_FALSE(append_on_full_disk(*store, first));
    ASSERT_FALSE(std::filesystem::exists(at / "author"));
    fsyncs.fail(at);
    append(*store, {first});
    EXPECT_THAT(store->author_error(), AllOf(HasSubstr(at.string()), HasSubstr("`author`")));
    fsyncs.fail({});
    ASSERT_FALSE(append_on_full_disk(*store, second));
    EXPECT_FALSE(store->must_stop());
  }
  const auto again = must(OperationStore::open(at, kWorld, {AuthorId{55}}));
  EXPECT_EQ(again->author(), AuthorId{55}) << "the second part may be at other peers";
}

TEST_F(Disk, AnAuthorWhoseContentsAreNotThereGetsNoName) {
  fsyncs.fail(at / "author.new");
  const auto store = must(open());
  EXPECT_THAT(store->author_error(), HasSubstr("Input/output error"));
  EXPECT_FALSE(std::filesystem::exists(at / "author"));
}

TEST_F(Disk, APeerWhoseAuthorCannotBeRemovedMustStop) {
  const OperationPart lost = part(kOwn, 200);
  auto store = must(open());
  fsyncs.fail(at);
  const auto refused = error_of(append_on_full_disk(*store, lost));
  EXPECT_TRUE(store->must_stop());
  EXPECT_THAT(refused.text, HasSubstr("This peer ends"));
}

// Whoever comes second must not take the first one's unfinished file away.
TEST_F(Store, OfManyWhoBeginItAtOnceOneHasIt) {
  for (int round = 0; round < 20; ++round) {
    const auto where = folder / ("store" + std::to_string(round));
    constexpr std::uint32_t kUsers = 8;
    std::barrier begin(kUsers), end(kUsers);
    std::atomic<std::uint32_t> users = 0, others = 0;
    {
      std::vector<std::jthread> threads;
      for (std::uint32_t i = 1; i <= kUsers; ++i) {
        threads.emplace_back([&, i] {
          begin.arrive_and_wait();
          const auto store = OperationStore::open(where, kWorld, {AuthorId{i}});
          if (store) {
            ++users;
          } else if (store.error().text.find("in use by another process") == std::string::npos) {
            ++others;
            ADD_FAILURE() << store.error().text;
          }
          end.arrive_and_wait();  // nobody comes after another has closed it
        });
      }
    }
    ASSERT_EQ(users, 1U);
    ASSERT_EQ(others, 0U);
    ASSERT_TRUE(OperationStore::open(where));
  }
}

TEST_F(Store, KeepsTheLineOfItsEdits) {
  {
    const auto store = must(open());
    EXPECT_EQ(store->line(), 0u);
    must(store->note_line(~std::uint64_t{0}));
  }
  {
    const auto store = must(open());
    EXPECT_EQ(store->line(), ~std::uint64_t{0});
    must(store->note_line(7));
  }
  EXPECT_EQ(must(OperationStore::open(at))->line(), 7u) << "to be read only";
}

}  // namespace peerd::store::operation_store_test
