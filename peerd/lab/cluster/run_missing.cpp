#include "peerd/lab/cluster/run_missing.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <iostream>
#include <memory>
#include <numeric>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "peerd/input/console/progress.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/lab/cluster/slurm.hpp"
#include "peerd/lab/cluster/tool.hpp"
#include "peerd/lab/live/child_process.hpp"

namespace peerd::cluster {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kNamesShown = 5;
constexpr std::chrono::milliseconds kProcessPause = 10ms, kResultPause = 250ms, kQueuePause = 2s;

// Both ways of running share these: what is shown, and what is an error.
class Waiting {
 public:
  Waiting(const WorkFolder& folder, const Running& running, const StopSignals& signals)
      : folder_(folder), running_(running), signals_(signals), display_(isatty(STDERR_FILENO) != 0) {}

  [[nodiscard]] std::size_t all() const { return folder_.work().items.size(); }
  [[nodiscard]] std::string items(std::size_t count) const { return counted(count, running_.unit); }

  void say(const std::string& line) {
    display_.clear();
    std::cerr << line << '\n';
  }
  void show(std::size_t missing, const std::string& where) {
    if (display_.due()) display_.show(fmt::format("{} of {} done, {}", all() - missing, items(all()), where));
  }
  void clear() { display_.clear(); }

  [[nodiscard]] InputError stopped() const {
    return {fmt::format("stopped by {}: what is done stays in {}; the same command again runs the rest",
                        signals_.signal_name(), folder_.folder().string()),
            signals_.exit_code()};
  }
  // `logs`: what the processes of the missing items have written.
  [[nodiscard]] InputError incomplete(const ItemList& missing, const std::string& logs) const {
    std::string names;
    for (std::size_t i = 0; i < std::min(missing.size(), kNamesShown); ++i) {
      names += (i > 0 ? ", " : "") + folder_.work().items[missing[i]];
    }
    if (missing.size() > kNamesShown) names += ", ..";
    return {fmt::format("error: {} of {} {} no result: {}; see {}; the same command again runs the rest",
                        missing.size(), items(all()), missing.size() == 1 ? "has" : "have", names, logs),
            3};
  }

 private:
  const WorkFolder& folder_;
  const Running& running_;
  const StopSignals& signals_;
  ProgressDisplay display_;
};

// The signal that has ended a process: at once, or by the exit code of one that has noted it (StopSignals).
std::optional<int> signal_of(const ChildProcess& process) {
  if (const auto signal = process.signal()) return signal;
  const int code = process.exit_code();
  return code == 128 + SIGINT || code == 128 + SIGTERM ? std::optional(code - 128) : std::nullopt;
}

// Processes of this computer, each of which does some of the items. One that dies takes down the item that it was at:
// the rest of its items goes to another one.
class LocalRun {
 public:
  LocalRun(const WorkFolder& folder, const Running& running, const StopSignals& signals)
      : folder_(folder), running_(running), signals_(signals), waiting_(folder, running, signals) {}

  Result<void> run(const ItemList& missing) {
    for (ItemList& items : deal(missing, running_.options.tasks)) queue_.push_back(std::move(items));
    std::size_t left = missing.size();
    auto next_look = std::chrono::steady_clock::now();
    while (!queue_.empty() || !children_.empty()) {
      if (signals_.signal() != 0) return std::unexpected(waiting_.stopped());
      while (!queue_.empty() && children_.size() < running_.processes) start();
      if (auto good = collect(); !good) return good;
      if (const auto now = std::chrono::steady_clock::now(); now >= next_look) {
        next_look = now + kResultPause;
        const auto standing = folder_.standing();
        if (!standing) return std::unexpected(standing.error());
        left = standing->missing.size();
      }
      waiting_.show(left, counted(children_.size(), "process", "processes"));
      std::this_thread::sleep_for(kProcessPause);
    }
    waiting_.clear();
    const auto standing = folder_.standing();
    if (!standing) return std::unexpected(standing.error());
    if (standing->missing.empty()) return {};
    return std::unexpected(waiting_.incomplete(standing->missing, folder_.logs().string()));
  }

 private:
  struct Child {
    ItemList items;
    std::unique_ptr<ChildProcess> process;
  };

  void start() {
    Child child{std::move(queue_.front()), nullptr};
    queue_.pop_front();
    std::vector<std::string> command = running_.command;
    command.push_back(range_text(child.items));
    const std::string& first = folder_.work().items[child.items.front()];
    child.process = std::make_unique<ChildProcess>(first, command, folder_.logs() / (first + ".txt"));
    children_.push_back(std::move(child));
  }

  // Takes the processes that have ended.
  Result<void> collect() {
    for (std::size_t i = 0; i < children_.size();) {
      if (children_[i].process->running()) {
        ++i;
        continue;
      }
      const Child ended = std::move(children_[i]);
      children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
      if (auto good = judge(ended); !good) return good;
    }
    return {};
  }

  Result<void> judge(const Child& ended) {
    const auto standing = folder_.standing();
    if (!standing) return std::unexpected(standing.error());
    if (!standing->failed.empty()) return std::unexpected(folder_.failure(standing->failed.front()));
    ItemList left;
    std::ranges::set_intersection(ended.items, standing->missing, std::back_inserter(left));
    const std::string log = ended.process->output().string();
    if (const auto signal = signal_of(*ended.process); signal && !left.empty()) {
      waiting_.say(fmt::format("{}: its process was ended by signal {} ({}); see {}",
                               folder_.work().items[left.front()], *signal, strsignal(*signal), log));
      left.erase(left.begin());  // a process does its items in their order
      if (!left.empty()) queue_.push_front(std::move(left));
      return {};
    }
    if (ended.process->exit_code() == 0 && left.empty()) return {};
    return std::unexpected(InputError{fmt::format("error: the process for {} ended with exit code {}; see {}",
                                                  ended.process->name(), ended.process->exit_code(), log),
                                      3});
  }

  const WorkFolder& folder_;
  const Running& running_;
  const StopSignals& signals_;
  Waiting waiting_;
  std::deque<ItemList> queue_;
  std::vector<Child> children_;
};

// An array job of Slurm.
class SlurmRun {
 public:
  SlurmRun(const WorkFolder& folder, const Running& running, const StopSignals& signals)
      : folder_(folder), running_(running), signals_(signals), waiting_(folder, running, signals) {}

  Result<void> run() {
    if (auto former = wait_for_former(); !former) return former;
    const auto standing = folder_.standing();
    if (!standing) return std::unexpected(standing.error());
    if (standing->missing.empty()) return {};
    const auto job = start(standing->missing);
    if (!job) return std::unexpected(job.error());
    const auto left = wait_for(*job);
    if (!left) return std::unexpected(left.error());
    if (left->empty()) return {};
    return std::unexpected(waiting_.incomplete(*left, folder_.logs().string()));
  }

 private:
  // A start that was killed has left its job behind.
  Result<void> wait_for_former() {
    const auto line = folder_.job();
    if (!line) return std::unexpected(line.error());
    if (!*line) return {};
    const auto job = slurm_job_from(**line);
    if (!job) return std::unexpected(job.error());
    const auto active = is_active(*job);
    if (!active) return std::unexpected(active.error());
    if (!*active) return {};
    waiting_.say("Slurm job " + job->id + " of an earlier start goes on");
    if (const auto left = wait_for(*job); !left) return std::unexpected(left.error());
    return {};
  }

  Result<SlurmJob> start(const ItemList& missing) {
    const auto options = split_words(running_.options.slurm_options);
    if (!options) return std::unexpected(options.error());
    const auto most = most_tasks();
    if (!most) return std::unexpected(most.error());
    SlurmArray array{.name = running_.name,
                     .tasks = deal(missing, std::min<std::size_t>(running_.options.tasks, *most)),
                     .command = running_.command,
                     .script = folder_.folder() / "job.sh",
                     .output = output_pattern(folder_.logs().string()) + "/job-%A-%a.txt",
                     .options = *options};
    const auto job = submit(array);
    if (!job) return job;
    waiting_.say(fmt::format("Slurm job {}: {} in {}", job->id, waiting_.items(missing.size()),
                             counted(array.tasks.size(), "task")));
    if (auto kept = folder_.keep_job(to_text(*job)); !kept) {
      if (const auto ended = cancel(*job); !ended) waiting_.say(ended.error().text);
      return std::unexpected(kept.error());
    }
    return job;
  }

  // Waits until all items have results, or the job is over: then some may be missing.
  Result<ItemList> wait_for(const SlurmJob& job) {
    auto next_question = std::chrono::steady_clock::now();
    bool controller_gone = false;
    for (bool active = true;;) {
      if (signals_.signal() != 0) return end(job, waiting_.stopped());
      const auto standing = folder_.standing();
      if (!standing) return std::unexpected(standing.error());
      if (!standing->failed.empty()) return end(job, folder_.failure(standing->failed.front()));
      if (standing->missing.empty() || !active) {
        waiting_.clear();
        return standing->missing;
      }
      waiting_.show(standing->missing.size(), "Slurm job " + job.id);
      std::this_thread::sleep_for(kResultPause);
      if (std::chrono::steady_clock::now() < next_question) continue;
      // The question that is asked first is answered before the results are counted: a task that ends between counts.
      const auto answer = is_active(job);
      if (!answer && !controller_gone) waiting_.say(answer.error().text + "; trying again");
      controller_gone = !answer;
      active = !answer || *answer;
      next_question = std::chrono::steady_clock::now() + kQueuePause;
    }
  }

  Result<ItemList> end(const SlurmJob& job, const InputError& why) {
    waiting_.clear();
    if (const auto ended = cancel(job); !ended) {
      return std::unexpected(InputError{ended.error().text + "\n" + why.text, why.exit_code});
    }
    return std::unexpected(why);
  }

  const WorkFolder& folder_;
  const Running& running_;
  const StopSignals& signals_;
  Waiting waiting_;
};

}  // namespace

Result<void> run_missing(const WorkFolder& folder, const Running& running, const StopSignals& signals) {
  assert(running.options.runner != Runner::kHere);
  if (running.options.runner == Runner::kSlurm) return SlurmRun(folder, running, signals).run();
  const auto standing = folder.standing();
  if (!standing) return std::unexpected(standing.error());
  return LocalRun(folder, running, signals).run(standing->missing);
}

Result<void> run_and_take(
    const WorkFolder& folder, const Running& running, const StopSignals& signals,
    const std::function<std::expected<void, std::string>(std::size_t item, std::string_view bytes)>& take) {
  ItemList wanted(folder.work().items.size());
  std::iota(wanted.begin(), wanted.end(), std::size_t{0});
  for (bool is_again = false; !wanted.empty(); is_again = true) {
    if (auto good = run_missing(folder, running, signals); !good) return good;
    ItemList damaged;
    for (const std::size_t item : wanted) {
      const auto bytes = folder.result(item);
      const auto taken = bytes ? take(item, *bytes) : std::unexpected(bytes.error());
      if (taken) continue;
      const std::string why = folder.work().items[item] + ": its result can't be used: " + taken.error();
      if (is_again) return std::unexpected(InputError{"error: " + why, kSystemFailed});
      std::cerr << why << "; it is run again\n";
      if (auto dropped = folder.drop_result(item); !dropped) return dropped;
      damaged.push_back(item);
    }
    wanted = std::move(damaged);
  }
  return {};
}

Result<void> run_items(const WorkFolder& folder, const std::string& items, const StopSignals& signals,
                       const RunItem& run_item) {
  const auto wanted = item_range_from(items, folder.work().items.size());
  if (!wanted)
    return std::unexpected(InputError{"error: --task " + items + " is no list of items of this work", kWrongUse});
  const auto standing = folder.standing();
  if (!standing) return std::unexpected(standing.error());
  for (const std::size_t item : standing->missing) {
    if (item < wanted->first || item > wanted->last) continue;
    auto bytes = signals.signal() == 0 ? run_item(item) : Result<std::optional<std::string>>(std::nullopt);
    if (!bytes) {
      const auto kept = folder.keep_failure(item, bytes.error());
      return std::unexpected(kept ? bytes.error() : kept.error());
    }
    if (!*bytes) return std::unexpected(InputError{"stopped by " + signals.signal_name(), signals.exit_code()});
    if (auto kept = folder.keep_result(item, **bytes); !kept) return kept;
  }
  return {};
}

}  // namespace peerd::cluster
