// The place of stores when nobody says so, and how one makes room for another.
#include "peerd/store/store_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "peerd/store/operation_store.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::store::store_folder_test {

using replication::AuthorId;
using testing::HasSubstr;
using testing_support::ScratchFolder;

class StoreFolder : public testing::Test {
 protected:
  void SetUp() override { setenv("XDG_STATE_HOME", folder.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_STATE_HOME"); }
  static auto open(const std::filesystem::path& at) { return OperationStore::open(at, 1, AuthorId{7}); }

  ScratchFolder folder;
};

TEST_F(StoreFolder, IsOfTheWorldAndOfThePeersName) {
  const auto peerd = folder / "peerd";
  EXPECT_EQ(default_folder(0xABC, "car"), peerd / "0000000000000abc" / "car");
  EXPECT_EQ(default_folder(0xABD, "car"), peerd / "0000000000000abd" / "car");
  EXPECT_EQ(default_folder(0xABC, "../car"), peerd / "0000000000000abc" / ".._car");
}

TEST_F(StoreFolder, OfASecondPeerOfThatNameIsAnother) {
  const auto first = default_folder(1, "car");
  ASSERT_TRUE(first);
  {
    const auto store = open(*first);
    ASSERT_TRUE(store) << store.error().text;
    EXPECT_EQ(default_folder(1, "car"), first->string() + ".2");
  }
  EXPECT_EQ(default_folder(1, "car"), first) << "it is free again";
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
  EXPECT_EQ(put_aside(at).value(), std::nullopt);
  for (const char* const aside : {"store.before", "store.before.2"}) {
    ASSERT_TRUE(open(at));
    EXPECT_EQ(put_aside(at).value(), folder / aside);
    EXPECT_FALSE(std::filesystem::exists(at));
    EXPECT_TRUE(OperationStore::open(folder / aside)) << "a store as it was";
  }
}

TEST_F(StoreFolder, AStoreInUseStaysWhereItIs) {
  const auto at = folder / "store";
  const auto store = open(at);
  ASSERT_TRUE(store);
  const auto aside = put_aside(at);
  ASSERT_FALSE(aside);
  EXPECT_THAT(aside.error().text, HasSubstr("in use by another process"));
  EXPECT_TRUE(OperationStore::exists(at));
}

}  // namespace peerd::store::store_folder_test
