#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <type_traits>

namespace peerd::bench {

// Calls `measure` in a process of its own, so that the most memory that it had at once is not that of an earlier
// measurement, and returns its result, a struct of plain numbers. Throws std::runtime_error where the process fails;
// `name` says on stderr which it was.
template <class Measure>
auto in_own_process(const char* name, Measure measure) {
  using Cost = std::invoke_result_t<Measure>;
  static_assert(std::is_trivially_copyable_v<Cost>);
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    try {
      const Cost cost = measure();
      _exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s\n", name, e.what());
      _exit(1);
    }
  }
  close(ends[1]);
  Cost cost;
  const bool whole = read(ends[0], &cost, sizeof cost) == sizeof cost;
  close(ends[0]);
  int status = 0;
  if (waitpid(child, &status, 0) != child || status != 0 || !whole) throw std::runtime_error("a measurement failed");
  return cost;
}

}  // namespace peerd::bench
