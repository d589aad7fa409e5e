#include "peerd/peer/store/stored_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::store::stored_world_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::ScratchFolder;

StoredWorld some(const std::string& name = "town") {
  return {name, 0xfedc'ba98'7654'3210, "[regions]\ncell_m = 10.0\n", std::string("bytes\0of an archive", 19)};
}

TEST(StoredWorld, IsThereAgain) {
  const ScratchFolder folder;
  EXPECT_FALSE(must(read_world_of_store(folder.path())));
  ASSERT_TRUE(write_world(folder.path(), some()));
  auto world = read_world_of_store(folder.path());
  ASSERT_TRUE(world && *world);
  EXPECT_EQ(**world, some());
  StoredWorld other = some("city");
  other.settings.clear();
  ASSERT_TRUE(write_world(folder.path(), other));
  world = read_world_of_store(folder.path());
  ASSERT_TRUE(world && *world);
  EXPECT_EQ(**world, other);
}

TEST(StoredWorld, DamageIsSaid) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_world(folder.path(), some()));
  const std::string good = testing_support::text_of(folder / "world.json");
  for (const char* const bad :
       {"", "[]", "{}", R"({"format":2})", R"({"format":1,"name":"a","genesis":"x","settings":""})"}) {
    folder.write("world.json", bad);
    const auto world = read_world_of_store(folder.path());
    ASSERT_FALSE(world) << bad;
    EXPECT_THAT(world.error().text, HasSubstr("world.json"));
    EXPECT_EQ(world.error().exit_code, 1);
  }
  folder.write("world.json", good);
  std::filesystem::remove(folder / "world.archive");
  EXPECT_FALSE(read_world_of_store(folder.path()));
}

TEST(StoredWorld, IsFoundByItsName) {
  const ScratchFolder folder;
  setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
  EXPECT_THAT(stores_of_world(""), IsEmpty());
  const auto a = folder / "peerd/1/a", b = folder / "peerd/1/b", c = folder / "peerd/2/a";
  for (const auto& each : {a, b, c}) std::filesystem::create_directories(each);
  ASSERT_TRUE(write_world(a, some()) && write_world(b, some("city")) && write_world(c, some()));
  EXPECT_THAT(stores_of_world("town"), ElementsAre(a, c));
  EXPECT_THAT(stores_of_world(""), ElementsAre(a, b, c));
  EXPECT_THAT(stores_of_world("village"), IsEmpty());
  unsetenv("XDG_STATE_HOME");
}

TEST(StoredWorld, WhatIsNotUnderstoodIsNotOverwritten) {
  const ScratchFolder folder;
  folder.write("world.json", "somebody's own");
  EXPECT_FALSE(write_world(folder.path(), some()));
  EXPECT_EQ(testing_support::text_of(folder / "world.json"), "somebody's own");
  EXPECT_FALSE(std::filesystem::exists(folder / "world.archive"));
}

TEST(Identity, IsOfTheStoresAuthor) {
  using replication::AuthorId;
  const ScratchFolder folder;
  EXPECT_EQ(identity_in(folder.path(), PeerId{7}, AuthorId{1}), PeerId{7});
  EXPECT_EQ(identity_in(folder.path(), PeerId{8}, AuthorId{1}), PeerId{7});
  EXPECT_EQ(identity_in(folder.path(), PeerId{9}, AuthorId{2}), PeerId{9}) << "a copy of the store";
  EXPECT_EQ(identity_in(folder.path(), PeerId{8}, AuthorId{2}), PeerId{9});
  for (const char* const bad : {"", "0 2\n", "-1 2\n", "7\n", "7 2 more\n", "4294967296 2\n"}) {
    folder.write("peer", bad);
    const auto id = identity_in(folder.path(), PeerId{8}, AuthorId{2});
    ASSERT_FALSE(id) << bad;
    EXPECT_THAT(id.error().text, HasSubstr("peer is damaged"));
  }
  EXPECT_EQ(error_of(identity_in(folder / "nowhere", PeerId{8}, AuthorId{2})).exit_code, 3);
}

}  // namespace peerd::store::stored_world_test
