#include "peerd/cli/lab/mcap_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/peerd/lab/recorded/recorded_run.hpp"

namespace peerd::mcap_command_test {

using nlohmann::json;
using testing::HasSubstr;
using testing_support::ScratchFolder;
using testing_support::SimulatedFolder;

// No file becomes longer than that while this lives, as on a disk that is full.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

// Another implementation reads what the file says: tests/browser/mcap_test.mjs.
TEST(McapExport, SaysWhatItHasWritten) {
  const SimulatedFolder folder(PEERD_SOURCE_DIR "/configs/scenarios/edits.toml");
  const auto file = folder.run() / "run.mcap";
  std::ostringstream out, err;
  ASSERT_EQ(run_mcap_export({.what = folder.run(), .file = file, .json = true}, out, err), 0) << err.str();
  const json said = json::parse(out.str());
  EXPECT_EQ(said.at("bytes"), std::filesystem::file_size(file));
  EXPECT_EQ(said.at("views").size(), 3u);
  EXPECT_GT(said.at("messages"), 1'000);
  EXPECT_EQ(said.at("notes"), json::array());
}

TEST(McapExport, WritesNothingWhereThereIsNothing) {
  const ScratchFolder folder;
  std::ostringstream out, err;
  EXPECT_EQ(run_mcap_export({.what = folder / "nothing", .file = folder / "a.mcap"}, out, err), 2);
  EXPECT_EQ(run_mcap_export({.what = folder.path(), .file = folder / "a.mcap"}, out, err), 2);
  EXPECT_THAT(err.str(), HasSubstr("it has no summary.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.mcap"));
  const SimulatedFolder run(PEERD_SOURCE_DIR "/configs/scenarios/edits.toml");
  EXPECT_EQ(run_mcap_export({.what = run.run(), .file = "/nowhere/a.mcap"}, out, err), 3);
  EXPECT_THAT(err.str(), HasSubstr("/nowhere/a.mcap: error: can't be written: No such file or directory"));
}

TEST(McapExport, LeavesNoHalfOfAFile) {
  const SimulatedFolder folder(PEERD_SOURCE_DIR "/configs/scenarios/edits.toml");
  const auto file = folder.run() / "run.mcap";
  std::ostringstream out, err;
  const FileSizeLimit limit(10'000);
  EXPECT_EQ(run_mcap_export({.what = folder.run(), .file = file}, out, err), 3);
  EXPECT_THAT(err.str(), HasSubstr("run.mcap: error: can't be written: File too large"));
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(run_mcap_export({.what = folder.run(), .file = folder.run() / "no/run.mcap"}, out, err), 3);
  EXPECT_THAT(err.str(), HasSubstr("no/run.mcap: error: can't be written: No such file or directory"));
}

}  // namespace peerd::mcap_command_test
