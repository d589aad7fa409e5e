#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace peerd::cluster {

// The programs that run the items of a work.
enum class Runner : std::uint8_t { kHere, kProcesses, kSlurm };

// The options of `peerd sim` that say where its runs are.
struct ClusterOptions {
  Runner runner = Runner::kHere;
  std::string slurm_options;      // of sbatch, as in a shell
  std::uint32_t tasks = 100;      // at most so many tasks, each of which is a process that does some of the items
  std::string items;              // not empty: this process is such a task, and these are its items (item_range_from)
  std::filesystem::path program;  // this program's file
  std::string version;            // of this program
};

}  // namespace peerd::cluster
