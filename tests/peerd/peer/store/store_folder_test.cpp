// The place of stores when nobody says so, and how one makes room for another.
#include "peerd/peer/store/store_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <barrier>
#include <cstdlib>
#include <set>
#include <thread>
#include <vector>

#include "peerd/peer/store/operation_store.hpp"
#include "tests/must.hpp"
#include "tests/peerd/peer/store/open_database.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::store::store_folder_test {

using replication::AuthorId;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::ScratchFolder;

class StoreFolder : public testing::Test {
 protected:
  void SetUp() override { setenv("XDG_STATE_HOME", folder.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_STATE_HOME"); }
  static auto open(const std::filesystem::path& at) { return OperationStore::open(at, 1, {AuthorId{7}}); }

  ScratchFolder folder;
};

TEST_F(StoreFolder, IsOfTheWorldAndOfThePeersName) {
  const auto peerd = folder / "peerd";
  EXPECT_EQ(default_folder(0xABC, "car"), peerd / "0000000000000abc" / "car");
  EXPECT_EQ(default_folder(0xABD, "car"), peerd / "0000000000000abd" / "car");
  EXPECT_EQ(default_folder(0xABC, "../car"), peerd / "0000000000000abc" / ".._car");
}

TEST_F(StoreFolder, OfANameThatIsNoneIsAFolderOfTheWorld) {
  for (const char* const name : {"", ".", ".."}) {
    EXPECT_EQ(default_folder(1, name), folder / "peerd" / "0000000000000001" / (std::string(name) + "_"));
  }
}

TEST_F(StoreFolder, OfASecondPeerOfThatNameIsAnother) {
  const auto car = folder / "car";
  {
    const auto first = lock_first_free(car), second = lock_first_free(car);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->folder(), car);
    EXPECT_EQ(second->folder(), car.string() + ".2");
  }
  EXPECT_EQ(lock_first_free(car).value().folder(), car) << "it is free again";
}

TEST_F(StoreFolder, OfManyPeersThatStartAtOnceEachIsAnother) {
  constexpr std::size_t kPeers = 16;
  std::vector<Result<FolderLock>> locks;
  for (std::size_t i = 0; i < kPeers; ++i) locks.emplace_back(std::unexpected(InputError{}));
  {
    std::barrier begin(kPeers);
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kPeers; ++i) {
      threads.emplace_back([&, i] {
        begin.arrive_and_wait();
        locks[i] = lock_first_free(folder / "car");
      });
    }
  }
  std::set<std::filesystem::path> folders;
  for (const auto& lock : locks) {
    ASSERT_TRUE(lock) << lock.error().text;
    folders.insert(lock->folder());
  }
  EXPECT_EQ(folders.size(), kPeers);
}

TEST_F(StoreFolder, ThatCannotBeMadeIsNamed) {
  folder.write("file", "");
  for (const auto& lock : {lock_folder(folder / "file" / "store"), lock_first_free(folder / "file" / "store")}) {
    ASSERT_FALSE(lock);
    EXPECT_THAT(lock.error().text, AllOf(HasSubstr((folder / "file" / "store").string()), HasSubstr("ot a directory")));
  }
}

TEST_F(StoreFolder, WithoutAHomeThereIsNone) {
  setenv("XDG_STATE_HOME", "relative", 1);
  const char* const home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  unsetenv("HOME");
  EXPECT_EQ(default_folder(1, "car"), std::nullopt);
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(default_folder(1, "car"), "/home/someone/.local/state/peerd/0000000000000001/car");
  before.empty() ? unsetenv("HOME") : setenv("HOME", before.c_str(), 1);
}

TEST_F(StoreFolder, PutAsideKeepsAllThatWasInIt) {
  const auto at = folder / "store";
  EXPECT_EQ(put_aside(lock_folder(at).value()).value(), std::nullopt) << "there is nothing";
  for (const char* const aside : {"store.before", "store.before.2"}) {
    ASSERT_TRUE(open(at));
    const std::string file = testing_support::text_of(at / "operations.sqlite");
    const std::string author = testing_support::text_of(at / "author");
    EXPECT_EQ(put_aside(lock_folder(at).value()).value(), folder / aside);
    EXPECT_FALSE(std::filesystem::exists(at));
    EXPECT_EQ(testing_support::text_of(folder / aside / "operations.sqlite"), file);
    EXPECT_EQ(testing_support::text_of(folder / aside / "author"), author);
  }
}

TEST_F(StoreFolder, ADamagedStoreCanBePutAside) {
  std::filesystem::create_directories(folder / "store");
  folder.write("store/operations.sqlite", "cut short");
  EXPECT_EQ(put_aside(lock_folder(folder / "store").value()).value(), folder / "store.before");
}

TEST_F(StoreFolder, WhatIsNoStoreStaysWhereItIs) {
  std::filesystem::create_directories(folder / "home");
  folder.write("home/letter.txt", "dear");
  ASSERT_TRUE(open(folder / "home"));
  EXPECT_THAT(error_of(put_aside(lock_folder(folder / "home").value())),
              IsError(2, AllOf(HasSubstr((folder / "home").string()), HasSubstr("letter.txt"))));
  EXPECT_EQ(testing_support::text_of(folder / "home" / "letter.txt"), "dear");
}

TEST_F(StoreFolder, AnotherProgramsDatabaseStaysWhereItIs) {
  std::filesystem::create_directories(folder / "theirs");
  {
    auto database = must(testing_support::open_database(folder / "theirs" / "operations.sqlite", true));
    ASSERT_TRUE(database.run("CREATE TABLE theirs (x)"));
  }
  EXPECT_THAT(error_of(put_aside(lock_folder(folder / "theirs").value())).text, HasSubstr("another program's"));
  EXPECT_TRUE(std::filesystem::exists(folder / "theirs" / "operations.sqlite"));
}

}  // namespace peerd::store::store_folder_test
