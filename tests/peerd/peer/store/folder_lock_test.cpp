// One process at a time has a folder, by whichever name.
#include "peerd/peer/store/folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::store::folder_lock_test {

using Making = FolderLock::Making;
using Why = LockError::Why;

class Lock : public testing::Test {
 protected:
  testing_support::ScratchFolder folder;
  std::filesystem::path at = folder / "a" / "b";
};

TEST_F(Lock, IsOfOneUntilItEnds) {
  {
    const auto first = must(FolderLock::take(at, Making::kFolders));
    EXPECT_EQ(first.folder(), at);
    EXPECT_EQ(FolderLock::take(at, Making::kFolders).error().why, Why::kInUse);
    EXPECT_EQ(FolderLock::take(folder / "a" / "." / "b", Making::kNone).error().why, Why::kInUse) << "by another path";
  }
  EXPECT_TRUE(FolderLock::take(at, Making::kNone));
  EXPECT_TRUE(std::filesystem::is_empty(at)) << "it leaves nothing in the folder";
}

TEST_F(Lock, MakesNoFolderUnlessItIsToldTo) {
  EXPECT_EQ(FolderLock::take(at, Making::kNone).error().why, Why::kMissing);
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}

TEST_F(Lock, GoesWithAFolderThatGetsAnotherName) {
  const auto lock = must(FolderLock::take(at, Making::kFolders));
  std::filesystem::rename(at, folder / "aside");
  EXPECT_EQ(FolderLock::take(folder / "aside", Making::kNone).error().why, Why::kInUse);
  EXPECT_TRUE(FolderLock::take(at, Making::kFolders)) << "a new folder";
}

TEST_F(Lock, IsMovedWithItsObject) {
  auto lock = must(FolderLock::take(at, Making::kFolders));
  {
    const FolderLock moved = std::move(lock);
    EXPECT_EQ(FolderLock::take(at, Making::kNone).error().why, Why::kInUse);
  }
  EXPECT_TRUE(FolderLock::take(at, Making::kNone));
}

TEST_F(Lock, EndsWithAProcessThatIsKilled) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto lock = FolderLock::take(at, Making::kFolders);
    const char good = lock ? 'y' : 'n';
    (void)!write(ready[1], &good, 1);
    pause();
    _exit(0);
  }
  char good = 'n';
  ASSERT_EQ(read(ready[0], &good, 1), 1);
  EXPECT_EQ(good, 'y');
  EXPECT_EQ(FolderLock::take(at, Making::kFolders).error().why, Why::kInUse);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(FolderLock::take(at, Making::kFolders));
  close(ready[0]);
  close(ready[1]);
}

}  // namespace peerd::store::folder_lock_test
