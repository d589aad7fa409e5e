#include "peerd/cli/shell/installed_files.hpp"

#include <gtest/gtest.h>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::installed_files_test {
namespace {

namespace fs = std::filesystem;
using testing_support::ScratchFolder;

class Installed : public testing::Test {
 protected:
  Installed() {
    for (const char* name : {"share/scenarios", "share/worlds", "share/baselines", "here"}) {
      fs::create_directories(folder / name);
    }
    for (const char* file : {"share/scenarios/town.toml", "share/scenarios/only.toml", "share/worlds/town.wrl",
                             "share/baselines/dis.toml", "share/best.toml", "here/town", "secret.toml"}) {
      folder.write(file, "");
    }
    before = fs::current_path();
    fs::current_path(folder / "here");
  }
  ~Installed() override { fs::current_path(before); }
  // Returns what becomes of a word.
  std::string as_scenario(std::string word) const { return changed(files.scenario(), std::move(word)); }
  std::string as_world(std::string word) const { return changed(files.world(), std::move(word)); }
  std::string as_settings(std::string word) const { return changed(files.settings(), std::move(word)); }
  static std::string changed(const CLI::Validator& validator, std::string word) {
    EXPECT_EQ(validator(word), "");
    return word;
  }

  ScratchFolder folder;
  fs::path before;
  InstalledFiles files{folder / "share"};
};

TEST_F(Installed, AreFoundByTheirNames) {
  EXPECT_EQ(as_scenario("only"), folder / "share/scenarios/only.toml");
  EXPECT_EQ(as_scenario("only.toml"), folder / "share/scenarios/only.toml");
  EXPECT_EQ(as_world("town.wrl"), folder / "share/worlds/town.wrl");
  EXPECT_EQ(as_settings("dis"), folder / "share/baselines/dis.toml");
  EXPECT_EQ(as_settings("best"), folder / "share/best.toml");
}

TEST_F(Installed, AreNotMeantWhereSomethingElseIs) {
  EXPECT_EQ(as_scenario("town"), "town") << "a file of that name is here";
  EXPECT_EQ(as_scenario("./only"), "./only");
  EXPECT_EQ(as_scenario("../secret"), "../secret");
  EXPECT_EQ(as_scenario("none"), "none") << "so the error names what was asked for";
  EXPECT_EQ(as_scenario("-"), "-");
  EXPECT_EQ(as_scenario(""), "");
}

TEST_F(Installed, AreThoseOfTheSourcesWhereTheProgramIsInABuild) {
  const InstalledFiles built = InstalledFiles::of_this_program("no/such/folder");
  EXPECT_EQ(built.find("server", {"baselines"}, ".toml"), fs::path(PEERD_SOURCE_DIR) / "configs/baselines/server.toml");
  EXPECT_FALSE(built.all("baselines", ".toml").empty());
}

TEST_F(Installed, AreNoneWhereNothingIsInstalled) {
  EXPECT_EQ(InstalledFiles({}).find("only", {"scenarios"}, ".toml"), std::nullopt);
  EXPECT_EQ(InstalledFiles::of_this_program("no/such/folder").find("only", {"scenarios"}, ".toml"), std::nullopt);
}

TEST_F(Installed, StandBesideTheProgram) {
  const auto program = fs::read_symlink("/proc/self/exe").parent_path();
  const auto found =
      InstalledFiles::of_this_program(fs::relative(folder / "share", program)).find("only", {"scenarios"}, ".toml");
  ASSERT_TRUE(found);
  EXPECT_TRUE(fs::equivalent(*found, folder / "share/scenarios/only.toml"));
}

}  // namespace
}  // namespace peerd::installed_files_test
