#include "peerd/lab/cluster/slurm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/lab/cluster/tool.hpp"
#include "tests/peerd/scratch_folder.hpp"

// A real Slurm is in tests/slurm.
namespace peerd::cluster::slurm_test {

using testing::HasSubstr;

TEST(SlurmJob, IsReadAsSbatchWritesIt) {
  EXPECT_EQ(slurm_job_from("123")->id, "123");
  EXPECT_EQ(slurm_job_from("123;far_1")->cluster, "far_1");
  for (const char* text : {"123", "9;far"}) EXPECT_EQ(to_text(*slurm_job_from(text)), text);
  for (const char* text : {"", ";", "12x", "-1", "1 2", "sbatch: error", "1;--x y", "1;a b"}) {
    EXPECT_EQ(slurm_job_from(text).error().exit_code, 3) << text;
  }
}

TEST(SlurmScript, GivesEachTaskItsItems) {
  const testing_support::ScratchFolder folder;
  const SlurmArray array{.name = "n",
                         .tasks = {{0, 1, 2}, {3}, {5, 7}},
                         .command = {"printf", "%s|", "it's", "a $b"},
                         .script = {},
                         .output = {},
                         .options = {}};
  const std::string script = folder.write("job.sh", script_of(array));
  const auto task = [&](const char* number) {
    return run_tool({"env", std::string("SLURM_ARRAY_TASK_ID=") + number, "sh", script});
  };
  EXPECT_EQ(task("1")->out, "it's|a $b|0-2|");
  EXPECT_EQ(task("2")->out, "it's|a $b|3-3|");
  EXPECT_EQ(task("3")->out, "it's|a $b|5-7|");
  EXPECT_EQ(task("4")->exit_code, 3);
  EXPECT_THAT(task("4")->err, HasSubstr("no task 4"));
}

TEST(SlurmScript, PercentSignsOfAFolderAreNoPattern) { EXPECT_EQ(output_pattern("/a%b/50%"), "/a%%b/50%%"); }

}  // namespace peerd::cluster::slurm_test
