#include "peerd/cli/program/lab_runs.hpp"

#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstring>

#include "peerd/cli/program/command.hpp"
#include "peerd/cli/shell/print.hpp"

namespace peerd {
namespace {

int start_lab(std::span<char*> words) {
  assert(words.data()[words.size()] == nullptr);  // as main() gets them
  const std::filesystem::path lab = program_beside("peerd-lab");
  execv(lab.c_str(), words.data());
  const int error = errno;
  if (error != ENOENT) return failed({"error: " + lab.string() + ": " + std::strerror(error), kSystemFailed});
  return failed(
      {"error: this needs the laboratory, which is not installed: install the package peerd-lab (there is no " +
           lab.string() + ")",
       kSystemFailed});
}

}  // namespace

LabRuns runs_of_other_program(std::span<char*> words) {
  const auto start = [words](const auto&...) { return start_lab(words); };
  return {start, start, start, start, start, start, start, start};
}

std::filesystem::path program_beside(const char* name) {
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename(name);
}

}  // namespace peerd
