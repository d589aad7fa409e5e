#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/input/input_error.hpp"
#include "peerd/lab/cluster/work_list.hpp"

namespace peerd::cluster {

// A job of Slurm. `cluster` is empty but where --slurm-options name another cluster than this computer's.
struct SlurmJob {
  std::string id, cluster;
};

// "ID" or "ID;CLUSTER", as sbatch --parsable writes it.
[[nodiscard]] std::string to_text(const SlurmJob& job);
[[nodiscard]] Result<SlurmJob> slurm_job_from(std::string_view text);

// A batch job is made of this.
struct SlurmArray {
  std::string name;
  std::vector<ItemList> tasks;
  std::vector<std::string> command;  // of a task; its items are appended as a word
  std::filesystem::path script;      // to be written and submitted
  std::string output;                // the path of a task's log, in which %a is the task's number
  std::vector<std::string> options;  // of sbatch; they replace those above
};

// The script of an array job: each task is the command with the items of its number, 1 being the first.
[[nodiscard]] std::string script_of(const SlurmArray& array);
// The path as one of sbatch's --output, in which % is special.
[[nodiscard]] std::string output_pattern(const std::string& path);

// The greatest number of tasks of an array job (MaxArraySize, less one because tasks are counted from 1).
[[nodiscard]] Result<std::size_t> most_tasks();
[[nodiscard]] Result<SlurmJob> submit(const SlurmArray& array);
// Whether some of the job waits, runs or ends. The error is one of the controller, which may be gone for a while.
[[nodiscard]] Result<bool> is_active(const SlurmJob& job);
[[nodiscard]] Result<void> cancel(const SlurmJob& job);

}  // namespace peerd::cluster
