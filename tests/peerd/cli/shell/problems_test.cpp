#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/printable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::problems_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

TEST(Problems, AWorldWithASceneIsGiven) {
  const ScratchFolder folder;
  std::ostringstream err;
  const auto world =
      must(open_world(folder.write("w.wrl", "#VRML V2.0 utf8\nDEF A Transform { }\n").string(), {}, err));
  EXPECT_TRUE(world->result.scene->find("A"));
  EXPECT_EQ(err.str(), "");
}

TEST(Problems, WhatIsNoWorldIsAnExitCodeAndASentence) {
  const ScratchFolder folder;
  std::ostringstream err;
  EXPECT_EQ(open_world((folder / "none.wrl").string(), {}, err).error(), 2);
  EXPECT_THAT(err.str(), HasSubstr("none.wrl: error: there is no such file"));
  EXPECT_EQ(open_world(folder.path().string(), {}, err).error(), 3);
  EXPECT_EQ(open_world(folder.write("w.wrl", "#VRML V2.0 utf8\nTransform {\n").string(), {}, err).error(), 1);
  EXPECT_THAT(err.str(), HasSubstr("w.wrl:"));
}

TEST(Problems, ManyAreCountedAndTheFirstOnesShown) {
  const ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 30; ++i) text += "Nonsense" + std::to_string(i) + " { }\n";
  const auto file = must(read_world_file(folder.write("w.wrl", text)));
  std::ostringstream err;
  const ProblemCount count = print_problems(file->result, err);
  EXPECT_EQ(count.errors + count.warnings, file->result.diagnostics.size());
  ASSERT_GT(std::max(count.errors, count.warnings), kShownProblems);
  EXPECT_THAT(err.str(), HasSubstr("Nonsense0"));
  EXPECT_THAT(err.str(), testing::Not(HasSubstr("Nonsense29")));
}

TEST(Counted, HasItsPlural) {
  EXPECT_EQ(counted(1, "error"), "1 error");
  EXPECT_EQ(counted(0, "error"), "0 errors");
  EXPECT_EQ(counted(2, "error"), "2 errors");
  EXPECT_EQ(counted(1, "hierarchy", "hierarchies"), "1 hierarchy");
  EXPECT_EQ(counted(2, "hierarchy", "hierarchies"), "2 hierarchies");
}

}  // namespace peerd::problems_test
