#include "peerd/lab/cluster/slurm.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/console/shell_word.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/cluster/tool.hpp"

namespace peerd::cluster {
namespace {

std::vector<std::string> with_cluster(std::vector<std::string> command, const SlurmJob& job) {
  if (!job.cluster.empty()) command.push_back("--clusters=" + job.cluster);
  return command;
}

std::string trimmed(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
  return text;
}

InputError refused(const std::string& tool, const ToolEnd& end) {
  const std::string said = trimmed(end.err.empty() ? end.out : end.err);
  return {fmt::format("error: {} failed with exit code {}{}{}", tool, end.exit_code, said.empty() ? "" : ": ", said),
          3};
}

}  // namespace

std::string to_text(const SlurmJob& job) { return job.id + (job.cluster.empty() ? "" : ";" + job.cluster); }

Result<SlurmJob> slurm_job_from(std::string_view text) {
  const std::size_t end = text.find(';');
  SlurmJob job{std::string(text.substr(0, end)),
               end == std::string_view::npos ? "" : std::string(text.substr(end + 1))};
  const bool number = !job.id.empty() && std::ranges::all_of(job.id, [](char c) { return c >= '0' && c <= '9'; });
  const bool named = std::ranges::all_of(
      job.cluster, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.'; });
  if (number && named) return job;
  return std::unexpected(InputError{"error: this names no job of Slurm: " + std::string(text), kSystemFailed});
}

std::string script_of(const SlurmArray& array) {
  std::string text = "#!/bin/sh\n# One task of an array job of peerd.\ncase $SLURM_ARRAY_TASK_ID in\n";
  for (std::size_t task = 0; task < array.tasks.size(); ++task) {
    text += fmt::format("  {}) items={} ;;\n", task + 1, range_text(array.tasks[task]));
  }
  text += "  *) echo \"no task $SLURM_ARRAY_TASK_ID\" >&2; exit 3 ;;\nesac\nexec";
  for (const std::string& word : array.command) text += ' ' + shell_word(word);
  return text + " \"$items\"\n";
}

std::string output_pattern(const std::string& path) {
  std::string pattern;
  for (const char c : path) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  return pattern;
}

Result<std::size_t> most_tasks() {
  const auto end = run_tool({"scontrol", "show", "config"});
  if (!end) return std::unexpected(end.error());
  if (end->exit_code != 0) return std::unexpected(refused("scontrol", *end));
  constexpr std::string_view kKey = "\nMaxArraySize";
  const std::size_t key = end->out.find(kKey);
  const std::size_t digits = key == std::string::npos ? key : end->out.find_first_of("0123456789\n", key + kKey.size());
  std::size_t size = 0;
  if (digits != std::string::npos) {
    std::from_chars(end->out.data() + digits, end->out.data() + end->out.size(), size);
  }
  if (size >= 2) return size - 1;
  return std::unexpected(
      InputError{"error: scontrol names no MaxArraySize of 2 or more: this Slurm runs no arrays", kSystemFailed});
}

Result<SlurmJob> submit(const SlurmArray& array) {
  if (auto written = write_text_file(array.script, script_of(array)); !written) return std::unexpected(written.error());
  std::vector<std::string> command{"sbatch", "--parsable", fmt::format("--array=1-{}", array.tasks.size()),
                                   "--job-name=" + array.name, "--output=" + array.output};
  command.insert(command.end(), array.options.begin(), array.options.end());
  command.push_back(array.script.string());
  const auto end = run_tool(command);
  if (!end) return std::unexpected(end.error());
  if (end->exit_code != 0) return std::unexpected(refused("sbatch", *end));
  return slurm_job_from(trimmed(end->out));
}

// squeue knows a job for a while after its end, and then says that its id is invalid.
Result<bool> is_active(const SlurmJob& job) {
  const auto end = run_tool(with_cluster({"squeue", "--noheader", "--format=%i", "--jobs=" + job.id}, job));
  if (!end) return std::unexpected(end.error());
  if (end->err.find("Invalid job id") != std::string::npos) return false;
  if (end->exit_code != 0) return std::unexpected(refused("squeue", *end));
  return end->out.find(job.id) != std::string::npos;
}

Result<void> cancel(const SlurmJob& job) {
  const auto end = run_tool(with_cluster({"scancel", job.id}, job));
  if (!end) return std::unexpected(end.error());
  if (end->exit_code != 0) return std::unexpected(refused("scancel", *end));
  return {};
}

}  // namespace peerd::cluster
