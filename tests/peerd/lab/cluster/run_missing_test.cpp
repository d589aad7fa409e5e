#include "peerd/lab/cluster/run_missing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "tests/must.hpp"
#include "tests/peerd/cli/program/program.hpp"
#include "tests/peerd/scratch_folder.hpp"

// The tasks are real processes: a shell that puts results in place which the test has made before.
namespace peerd::cluster::run_missing_test {

using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;
using testing_support::text_of;

class RunMissing : public testing::Test {
 protected:
  RunMissing() {
    for (int item = 0; item < 6; ++item) work.items.push_back("run-" + std::to_string(item));
    const auto other = WorkFolder::take(folder / "made", work);
    for (std::size_t item = 0; item < work.items.size(); ++item) {
      EXPECT_TRUE(other->keep_result(item, "result " + std::to_string(item)));
    }
    running.options.runner = Runner::kProcesses;
    running.processes = 2;
    running.unit = "run";
  }
  // The tasks of this script: $1 is the first of the items, $2 the last, and `put N` leaves the result of one.
  void run_script(const std::string& lines) {
    const auto script = folder.write("task.sh", "put() { cp '" + (folder / "made/results/run-").string() +
                                                    "'$1.result '" + (folder / "work/results").string() + "/'; }\n" +
                                                    "set -- ${1%-*} ${1#*-}\n" + lines + "\n");
    running.command = {"sh", script.string()};
  }
  std::vector<std::string> results() {
    std::vector<std::string> taken;
    const auto folder_of_work = WorkFolder::take(folder / "work", work);
    EXPECT_TRUE(folder_of_work);
    testing::internal::CaptureStderr();
    const StopSignals signals("");
    const auto done = run_and_take(*folder_of_work, running, signals,
                                   [&](std::size_t, std::string_view bytes) -> std::expected<void, std::string> {
                                     taken.emplace_back(bytes);
                                     return {};
                                   });
    err = testing::internal::GetCapturedStderr();
    error = done ? InputError{"", 0} : done.error();
    left = folder_of_work->standing()->missing;
    return taken;
  }
  testing_support::ScratchFolder folder;
  Work work{"sim", "peerd 1", hash_hex("p"), hash_hex("s"), {}};
  Running running;
  InputError error;
  ItemList left;
  std::string err;
};

const std::string kPutAll = "for i in $(seq $1 $2); do put $i; done";

TEST_F(RunMissing, HandsOutAllResultsInOrder) {
  run_script("sleep 0.0$((5 - $1)); " + kPutAll);  // the last ones come first
  EXPECT_THAT(results(), ElementsAre("result 0", "result 1", "result 2", "result 3", "result 4", "result 5"));
  EXPECT_EQ(error.text, "");
  EXPECT_EQ(err, "");
}

TEST_F(RunMissing, NamesTheRunWhoseProcessDiesAndDoesTheOthers) {
  running.options.tasks = 2;
  run_script("for i in $(seq $1 $2); do [ $i != 1 ] || kill -9 $$; put $i; done");
  EXPECT_THAT(results(), IsEmpty());
  EXPECT_THAT(err, HasSubstr("run-1: its process was ended by signal 9 (Killed)"));
  EXPECT_EQ(error.exit_code, 3);
  EXPECT_THAT(error.text, HasSubstr("1 of 6 runs has no result: run-1; see"));
  EXPECT_THAT(left, ElementsAre(1));
  run_script("echo $1 $2 >>'" + (folder / "started").string() + "'; " + kPutAll);
  EXPECT_EQ(results().size(), 6U);
  EXPECT_EQ(text_of(folder / "started"), "1 1\n") << "the others are not run again";
}

// peerd notes SIGTERM and ends by itself, with the exit code that a shell has for it.
TEST_F(RunMissing, AProcessThatASignalMadeLeaveTakesNoOtherWithIt) {
  running.options.tasks = 3;
  run_script("for i in $(seq $1 $2); do [ $i != 1 ] || exit 143; put $i; done");
  EXPECT_THAT(results(), IsEmpty());
  EXPECT_THAT(err, HasSubstr("run-1: its process was ended by signal 15 (Terminated)"));
  EXPECT_THAT(left, ElementsAre(1));
}

TEST_F(RunMissing, AnErrorOfATaskEndsAllAndIsShown) {
  running.processes = 1;
  run_script("echo no such world >&2; exit 3");
  EXPECT_THAT(results(), IsEmpty());
  EXPECT_EQ(error.exit_code, 3);
  EXPECT_THAT(error.text, HasSubstr("ended with exit code 3; see"));
  EXPECT_EQ(text_of(folder / "work/logs/run-0.txt"), "no such world\n");
}

TEST_F(RunMissing, AProgramThatCannotBeStartedIsAnError) {
  running.command = {(folder / "nothing").string()};
  EXPECT_THAT(results(), IsEmpty());
  EXPECT_EQ(error.exit_code, 3);
}

TEST_F(RunMissing, TheErrorOfARunIsTheErrorOfAll) {
  const auto other = WorkFolder::take(folder / "failures", work);
  ASSERT_TRUE(other->keep_failure(2, {"error: this system has no such event", 1}));
  run_script("cp '" + (folder / "failures/results/run-2.failed").string() + "' '" +
             (folder / "work/results/").string() + "'; exit 1");
  EXPECT_THAT(results(), IsEmpty());
  EXPECT_EQ(error.exit_code, 1);
  EXPECT_EQ(error.text, "error: this system has no such event");
}

TEST_F(RunMissing, ADamagedResultIsRunAgainOnce) {
  run_script("if [ ! -e '" + (folder / "once").string() + "' ]; then touch '" + (folder / "once").string() + "'; " +
             kPutAll + "; echo x >>'" + (folder / "work/results/run-3.result").string() + "'; else " + kPutAll +
             "; fi");
  running.options.tasks = 1;
  EXPECT_EQ(results().size(), 6U);
  EXPECT_THAT(err, HasSubstr("run-3: its result can't be used: it is damaged; it is run again"));
  std::filesystem::remove_all(folder / "work");
  run_script(kPutAll + "; echo x >>'" + (folder / "work/results/run-3.result").string() + "'");
  (void)results();
  EXPECT_EQ(error.exit_code, 3);
  EXPECT_THAT(error.text, HasSubstr("run-3: its result can't be used"));
}

TEST_F(RunMissing, ASignalEndsTheProcesses) {
  running.options.tasks = 6;
  run_script("if [ $1 = 0 ]; then put 0; kill -TERM " + std::to_string(getpid()) + "; fi; exec sleep 600");
  const auto folder_of_work = WorkFolder::take(folder / "work", work);
  StopSignals signals("");
  signals.note_from_now_on("");
  EXPECT_THAT(error_of(run_missing(*folder_of_work, running, signals)), IsError(143, HasSubstr("stopped by SIGTERM")));
  EXPECT_THAT(folder_of_work->standing()->missing, ElementsAre(1, 2, 3, 4, 5));
}

// The program itself.
class SimOn : public testing_support::Program {
 protected:
  SimOn() {
    folder.write("w.wrl", testing_support::kStillWorld);
    folder.write("s.toml", std::string(testing_support::kMovingBox) + "[peer.b]\nid = 2\n");
  }
  void expect_same_report(const char* a, const char* b) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / a)) {
      if (!entry.is_regular_file()) continue;
      const auto name = entry.path().filename().string();
      EXPECT_EQ(text_of(folder / b / name), text_of(entry.path())) << name;
      ++files;
    }
    EXPECT_EQ(files, 6);
  }
};

const std::string kSweep = "sim s.toml --set 'network.latency_ms=[0, 50, 100]' --repeat 2 ";

TEST_F(SimOn, ProcessesGivesTheReportOfOneProcess) {
  const auto here = run(kSweep + "--json --out here");
  ASSERT_EQ(here.exit_code, 0) << here.err;
  const auto there = run(kSweep + "--json --on processes --tasks 4 --jobs 2 --out there");
  ASSERT_EQ(there.exit_code, 0) << there.err;
  EXPECT_EQ(there.out, here.out);
  expect_same_report("here", "there");
  const auto again = run(kSweep + "--on processes --out there");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  expect_same_report("here", "there");
}

TEST_F(SimOn, AnotherSweepInTheFolderIsRefused) {
  ASSERT_EQ(run("sim s.toml --on processes --out o").exit_code, 0);
  for (const char* other : {"--set network.latency_ms=3", "--seed 9", "--repeat 2"}) {
    const auto said = run(std::string("sim s.toml --on processes --out o ") + other);
    EXPECT_EQ(said.exit_code, 2) << other;
    EXPECT_THAT(said.err, HasSubstr("has results of another sweep: the scenario, its settings"));
  }
  folder.write("w.wrl", std::string(testing_support::kStillWorld) + "# changed\n");
  EXPECT_EQ(run("sim s.toml --on processes --out o").exit_code, 2);
}

TEST_F(SimOn, ChaosGivesTheSameLines) {
  const std::string chaos = "sim --chaos 1..3 --chaos-seconds 22 --chaos-peers 2 --json";
  const auto here = run(chaos);
  ASSERT_EQ(here.exit_code, 0) << here.out << here.err;
  const auto there = run(chaos + " --on processes --out c");
  EXPECT_EQ(there.exit_code, 0) << there.err;
  EXPECT_EQ(there.out, here.out);
}

struct Wrong {
  const char *name, *options, *says;
};
class WrongUse : public SimOn, public testing::WithParamInterface<Wrong> {};
TEST_P(WrongUse, IsExplained) {
  const auto said = run(std::string("sim s.toml ") + GetParam().options);
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr(GetParam().says));
}
INSTANTIATE_TEST_SUITE_P(Table, WrongUse,
                         testing::Values(Wrong{"Runner", "--on clouds", "--on"}, Wrong{"Tasks", "--tasks 3", "--tasks"},
                                         Wrong{"NoTasks", "--on processes --tasks 0", "--tasks"},
                                         Wrong{"Jobs", "--on slurm --jobs 2", "--jobs is of this computer"},
                                         Wrong{"Options", "--on processes --slurm-options=-q",
                                               "--slurm-options needs --on slurm"},
                                         Wrong{"Verbose", "--on processes -v", "--verbose"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace peerd::cluster::run_missing_test
