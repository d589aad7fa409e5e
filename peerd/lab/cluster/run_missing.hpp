#pragma once
#include <cstddef>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/input/console/stop_signals.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/lab/cluster/cluster_options.hpp"
#include "peerd/lab/cluster/work_folder.hpp"

namespace peerd::cluster {

// How the missing items of a folder are run.
struct Running {
  ClusterOptions options;
  std::size_t processes = 1;         // with Runner::kProcesses: how many at once
  std::string name;                  // of the job
  std::string unit;                  // what an item is called: "run", "seed"
  std::vector<std::string> command;  // of a task; its items are appended as a word
};

// Has all missing items of the folder run, and waits for them. With Slurm, a job that an earlier start has left is
// waited for first. The error names the items that are still missing, and why; those that are there stay. A signal
// cancels the job, or ends the processes; it is an error with that signal's exit code.
[[nodiscard]] Result<void> run_missing(const WorkFolder& folder, const Running& running, const StopSignals& signals);

// The same, and then hands each item's result to `take`, in order of the items. A result that can't be read, or that
// `take` refuses with a sentence, is run again, once.
[[nodiscard]] Result<void> run_and_take(
    const WorkFolder& folder, const Running& running, const StopSignals& signals,
    const std::function<std::expected<void, std::string>(std::size_t item, std::string_view bytes)>& take);

// The result of an item, as bytes; none: a signal has stopped it. An error is the item's own.
using RunItem = std::function<Result<std::optional<std::string>>(std::size_t item)>;
// This process is a task: it runs those of `items` (--task) that have no result yet, and leaves their results, or the
// first error, in the folder. A signal is an error with its exit code.
[[nodiscard]] Result<void> run_items(const WorkFolder& folder, const std::string& items, const StopSignals& signals,
                                     const RunItem& run_item);

}  // namespace peerd::cluster
