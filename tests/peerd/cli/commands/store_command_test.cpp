#include "peerd/cli/commands/store_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/stored_world.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/replication/peer/operations.hpp"

namespace peerd::store_command_test {

using replication::AuthorId;
using testing::AllOf;
using testing::HasSubstr;
using testing::internal::CaptureStderr, testing::internal::GetCapturedStderr;

class StoreCommand : public testing::Test {
 protected:
  StoreCommand() {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
    begin(must(config::load_world(folder / "w.wrl", {})).hash);
  }
  // A store in which author 7 has added BOX.
  void begin(std::uint64_t genesis) {
    auto store = must(store::OperationStore::open(folder / "store", genesis, {AuthorId{7}}));
    const replication::Operation add{{AuthorId{7}, 1},
                                     SimTime{std::chrono::milliseconds(2500)},
                                     replication::AddNodes{{}, {}, "#VRML V2.0 utf8\nDEF BOX Group { }\n", 0, 0, {}}};
    bytes = replication::encode(add);
    const replication::OperationPart part{AuthorId{7}, 0, bytes};
    must(store->append({&part, 1}));
  }
  int check(bool json) {
    return said([&] { return run_store_check({folder / "store", json}, out); });
  }
  int write(const std::string& world) {
    const auto file = world.empty() ? std::filesystem::path() : folder / world;
    return said([&] { return run_store_export({folder / "store", file, {}, {}}, out); });
  }
  template <class Command>
  int said(Command command) {
    out.str("");
    CaptureStderr();
    const int code = command();
    err = GetCapturedStderr();
    return code;
  }

  testing_support::ScratchFolder folder;
  std::vector<std::byte> bytes;
  std::ostringstream out;
  std::string err;
};

TEST_F(StoreCommand, CheckSaysWhatIsThere) {
  EXPECT_EQ(check(false), 0) << err;
  EXPECT_THAT(out.str(),
              AllOf(HasSubstr("1 operation of 1 author"), HasSubstr("author 7, this store's own: 1 operation"),
                    HasSubstr("time 2.500 s"), HasSubstr("bytes in a file of ")));
}

TEST_F(StoreCommand, CheckSaysItInJson) {
  EXPECT_EQ(check(true), 0) << err;
  const auto all = nlohmann::json::parse(out.str());
  EXPECT_EQ(all["store"], (folder / "store").string());
  EXPECT_EQ(all["author"], 7);
  EXPECT_EQ(all["operations"], 1);
  EXPECT_EQ(all["bytes"], bytes.size());
  EXPECT_EQ(all["logs"].size(), 1U);
  EXPECT_EQ(all["logs"][0]["last_stamp_s"], 2.5);
  EXPECT_GE(all["file_bytes"], 4096);
}

TEST_F(StoreCommand, CheckSaysThatThePeerOfACopyBeginsALogOfItsOwn) {
  std::filesystem::rename(folder / "store", folder / "before");
  std::filesystem::copy(folder / "before", folder / "store", std::filesystem::copy_options::recursive);
  EXPECT_EQ(check(true), 0) << err;
  EXPECT_TRUE(nlohmann::json::parse(out.str())["author"].is_null());
}

TEST_F(StoreCommand, CheckOfNoneIsWrongUse) {
  std::filesystem::remove_all(folder / "store");
  EXPECT_EQ(check(false), 2);
  EXPECT_THAT(err, AllOf(HasSubstr("there is no store in"), HasSubstr((folder / "store").string())));
  EXPECT_FALSE(std::filesystem::exists(folder / "store"));
}

TEST_F(StoreCommand, ExportHasTheWorldAndItsOperations) {
  EXPECT_EQ(write("w.wrl"), 0) << err;
  EXPECT_THAT(out.str(), AllOf(HasSubstr("DEF CAR "), HasSubstr("DEF BOX ")));
}

TEST_F(StoreCommand, ExportNeedsNoFileWhereTheStoreKeepsTheWorld) {
  EXPECT_EQ(write(""), 2);
  EXPECT_THAT(err, AllOf(HasSubstr("keeps no world"), HasSubstr("--world FILE")));
  WorldReading reading;
  reading.keeps_archive = true;
  const auto world = must(config::load_world(folder / "w.wrl", reading));
  const store::StoredWorld kept{"mine", world.hash, "", world.archive};
  ASSERT_TRUE(store::write_world(folder / "store", kept));
  EXPECT_EQ(write(""), 0) << err;
  EXPECT_THAT(out.str(), AllOf(HasSubstr("DEF CAR "), HasSubstr("DEF BOX ")));
}

TEST_F(StoreCommand, ExportOfAnotherWorldIsRefused) {
  folder.write("other.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { }\n");
  EXPECT_EQ(write("other.wrl"), 2);
  EXPECT_THAT(err, AllOf(HasSubstr("is of another world"), HasSubstr("other.wrl")));
  EXPECT_EQ(out.str(), "");
}

}  // namespace peerd::store_command_test
