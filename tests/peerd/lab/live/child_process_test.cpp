#include "peerd/lab/live/child_process.hpp"

#include <gtest/gtest.h>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include "tests/peerd/comes_true.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::child_process_test {

using testing_support::ScratchFolder;
using testing_support::text_of;

bool ends_within(ChildProcess& child, double seconds) {
  return testing_support::comes_true([&] { return !child.running(); }, seconds);
}

TEST(ChildProcess, ItsOutputAndItsExitCodeAreKept) {
  const ScratchFolder folder;
  ChildProcess child("a", {"sh", "-c", "echo said; echo complained >&2; exit 7"}, folder / "out");
  EXPECT_EQ(child.name(), "a");
  ASSERT_TRUE(ends_within(child, 10));
  EXPECT_EQ(child.exit_code(), 7);
  EXPECT_FALSE(child.killed());
  EXPECT_EQ(text_of(folder / "out"), "said\ncomplained\n");
}

TEST(ChildProcess, AProgramThatIsNotThereHasEndedWithThree) {
  const ScratchFolder folder;
  ChildProcess child("a", {"/nonexistent/program"}, folder / "out");
  EXPECT_TRUE(ends_within(child, 10));
  EXPECT_EQ(child.exit_code(), 3);
}

// A process of its own makes the child, says which it is, and is killed.
TEST(ChildProcess, DoesNotOutliveAParentThatIsKilled) {
  const ScratchFolder folder;
  std::array<int, 2> said{};
  ASSERT_EQ(pipe(said.data()), 0);
  const pid_t parent = fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    const ChildProcess child("a", {"sh", "-c", "echo $$; exec sleep 60"}, folder / "child");
    close(said[0]);
    pause();
    _exit(0);
  }
  close(said[1]);
  std::string id;
  while (id.empty() || id.back() != '\n') {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    id = text_of(folder / "child");
  }
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd end{said[0], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 20'000), 1) << "the pipe ends with its last writer, which is the child";
  close(said[0]);
}

TEST(ChildProcess, IsEndedBySignalsEvenWhereItsParentBlocksThem) {
  const ScratchFolder folder;
  sigset_t term, before;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  sigprocmask(SIG_BLOCK, &term, &before);
  ChildProcess leaves("a", {"sleep", "60"}, folder / "a"), killed("b", {"sleep", "60"}, folder / "b");
  sigprocmask(SIG_SETMASK, &before, nullptr);
  EXPECT_TRUE(leaves.running());
  leaves.end(SIGTERM);
  killed.end(SIGKILL);
  EXPECT_TRUE(ends_within(leaves, 10));
  EXPECT_TRUE(ends_within(killed, 10));
  EXPECT_EQ(leaves.exit_code(), 3);
  EXPECT_FALSE(leaves.killed());
  EXPECT_TRUE(killed.killed());
}

TEST(ChildProcess, DoesNotOutliveItsObject) {
  const ScratchFolder folder;
  {
    ChildProcess stubborn("a", {"sh", "-c", "trap '' TERM; echo $$; while true; do sleep 0.05; done"}, folder / "pid");
    for (int tries = 0; tries < 1000 && text_of(folder / "pid").empty(); ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  const int pid = std::stoi(text_of(folder / "pid"));
  EXPECT_EQ(kill(pid, 0), -1) << "killed where SIGTERM did not help";
}

}  // namespace peerd::child_process_test
