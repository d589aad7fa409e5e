#include "peerd/cli/program/lab_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::lab_runs_test {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;

TEST(ProgramBeside, IsInTheFolderOfThisOne) {
  EXPECT_EQ(program_beside("peerd-lab"), fs::read_symlink("/proc/self/exe").parent_path() / "peerd-lab");
}

class LabRunsProgram : public Program {
 protected:
  LabRunsProgram() {
    folder.write("w.wrl", testing_support::kStillWorld);
    folder.write("s.toml", testing_support::kMovingBox);
  }
};

TEST_F(LabRunsProgram, TheLaboratoryRunsWithTheSameWords) {
  const Said said = run("sim s.toml --seed 7 --json --out results");
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr(R"("seed": 7)"));
  EXPECT_TRUE(fs::exists(folder / "results/summary.json"));
}

TEST_F(LabRunsProgram, WhereItIsNotInstalledItsPackageIsNamed) {
  const std::string alone = folder / "peerd";
  fs::copy_file(PEERD_PROGRAM, alone);
  for (const char* words : {"sim s.toml", "scenario s.toml", "compare s.toml", "volumes w.wrl", "sim --chaos 1",
                            "replay s.toml", "view s.toml", "export w.wrl --mcap m.mcap"}) {
    const Said said = run(words, alone);
    EXPECT_EQ(said.exit_code, 3) << words;
    EXPECT_THAT(said.err, HasSubstr("install the package peerd-lab")) << words;
    EXPECT_EQ(said.out, "") << words;
  }
  EXPECT_EQ(run("check w.wrl", alone).exit_code, 0) << "all else works without it";
  EXPECT_EQ(run("sim --seed -1 s.toml", alone).exit_code, 2) << "wrong use is said without it, too";
}

}  // namespace peerd::lab_runs_test
