#include "peerd/lab/cluster/work_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::cluster::work_folder_test {

using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;
namespace fs = std::filesystem;

const Work kWork{"sim", "peerd 1.2.3", hash_hex("program"), hash_hex("settings"), {"run-001", "run-002", "run-003"}};

class WorkFolderTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path result_file(const char* item) const {
    return folder / (std::string("out/work/results/") + item + ".result");
  }
  testing_support::ScratchFolder folder;
  fs::path work = folder / "out/work";
};

TEST(HashHex, IsBlake2b) {  // b2sum -l 128
  EXPECT_EQ(hash_hex(""), "cae66941d9efbd404e4d88758ea67670");
}

TEST_F(WorkFolderTest, KeepsResultsForEverybody) {
  const auto taken = must(WorkFolder::take(work, kWork));
  EXPECT_THAT(taken.standing()->missing, ElementsAre(0, 1, 2));
  const auto task = must(WorkFolder::join(work, kWork));
  const std::string bytes("\0\xff\n", 3);
  ASSERT_TRUE(task.keep_result(1, bytes));
  EXPECT_THAT(taken.standing()->missing, ElementsAre(0, 2));
  EXPECT_EQ(taken.result(1), bytes);
  ASSERT_TRUE(taken.drop_result(1));
  EXPECT_THAT(taken.standing()->missing, ElementsAre(0, 1, 2));
}

TEST_F(WorkFolderTest, LeavesNoUnfinishedFile) {
  const auto taken = WorkFolder::take(work, kWork);
  ASSERT_TRUE(taken->keep_result(0, "x"));
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(work / "results")) names.push_back(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("run-001.result"));
}

TEST_F(WorkFolderTest, BelongsToOneProcessAtATime) {
  {
    const auto taken = WorkFolder::take(work, kWork);
    EXPECT_THAT(error_of(WorkFolder::take(work, kWork)), IsError(3, HasSubstr("is in use")));
  }
  EXPECT_TRUE(WorkFolder::take(work, kWork));
}

struct Other {
  const char* name;
  Work work;
  const char* says;
};
class OtherWork : public WorkFolderTest, public testing::WithParamInterface<Other> {};
TEST_P(OtherWork, IsRefused) {
  ASSERT_TRUE(WorkFolder::take(work, kWork));
  const auto taken = WorkFolder::take(work, GetParam().work);
  const auto joined = WorkFolder::join(work, GetParam().work);
  ASSERT_FALSE(taken.has_value() || joined.has_value());
  for (const InputError& error : {taken.error(), joined.error()}) {
    EXPECT_EQ(error.exit_code, 2);
    EXPECT_THAT(error.text, HasSubstr(GetParam().says));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, OtherWork,
    testing::Values(
        Other{"Kind", {"chaos", kWork.version, kWork.program, kWork.settings, kWork.items}, "other runs"},
        Other{"Version", {"sim", "peerd 2", hash_hex("new"), kWork.settings, kWork.items}, "peerd 2 here"},
        Other{"Program", {"sim", kWork.version, hash_hex("new"), kWork.settings, kWork.items}, "file is another"},
        Other{"Settings", {"sim", kWork.version, kWork.program, hash_hex("x"), kWork.items}, "its seeds"},
        Other{"Items", {"sim", kWork.version, kWork.program, kWork.settings, {"a", "b", "c"}}, "other runs"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(WorkFolderTest, ADamagedManifestIsRefused) {
  ASSERT_TRUE(WorkFolder::take(work, kWork));
  for (const char* text : {"", "{", "[]", "{}"}) {
    folder.write("out/work/manifest.json", text);
    EXPECT_EQ(WorkFolder::take(work, kWork).error().exit_code, 2) << text;
  }
}

TEST_F(WorkFolderTest, ATaskNeedsTheFolder) { EXPECT_FALSE(WorkFolder::join(work, kWork)); }

TEST_F(WorkFolderTest, ADamagedResultIsRefused) {
  const auto taken = WorkFolder::take(work, kWork);
  ASSERT_TRUE(taken->keep_result(0, "some bytes"));
  const std::string whole = testing_support::text_of(result_file("run-001"));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string other = whole;
    other[at] = static_cast<char>(other[at] ^ 1);
    folder.write("out/work/results/run-001.result", other);
    EXPECT_FALSE(taken->result(0)) << at;
    folder.write("out/work/results/run-001.result", whole.substr(0, at));
    EXPECT_FALSE(taken->result(0)) << at;
  }
  folder.write("out/work/results/run-001.result", whole);
  EXPECT_EQ(taken->result(0), "some bytes");
}

TEST_F(WorkFolderTest, AResultOfAnotherItemOrWorkIsRefused) {
  const auto taken = WorkFolder::take(work, kWork);
  ASSERT_TRUE(taken->keep_result(0, "x"));
  fs::copy_file(result_file("run-001"), result_file("run-002"));
  EXPECT_EQ(taken->result(1).error(), "it is of another run");
  Work other = kWork;
  other.settings = hash_hex("other");
  const auto second = WorkFolder::take(folder / "second", other);
  fs::copy_file(result_file("run-001"), folder / "second/results/run-001.result");
  EXPECT_EQ(second->result(0).error(), "it is of another run");
}

TEST_F(WorkFolderTest, AFailureStaysUntilTheNextStart) {
  {
    const auto taken = WorkFolder::take(work, kWork);
    ASSERT_TRUE(taken->keep_failure(2, {"error: two\nlines", 1}));
    EXPECT_THAT(taken->standing()->missing, ElementsAre(0, 1, 2));
    EXPECT_THAT(taken->standing()->failed, ElementsAre(2));
    EXPECT_EQ(taken->failure(2).text, "error: two\nlines");
    EXPECT_EQ(taken->failure(2).exit_code, 1);
  }
  EXPECT_THAT(WorkFolder::take(work, kWork)->standing()->failed, IsEmpty());
}

TEST_F(WorkFolderTest, RemembersItsJob) {
  const auto taken = WorkFolder::take(work, kWork);
  EXPECT_EQ(*taken->job(), std::nullopt);
  ASSERT_TRUE(taken->keep_job("17"));
  ASSERT_TRUE(taken->keep_job("18;far"));
  EXPECT_EQ(*taken->job(), "18;far");
}

}  // namespace peerd::cluster::work_folder_test
