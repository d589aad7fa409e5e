#pragma once
#include <string>
#include <vector>

#include "peerd/input/input_error.hpp"

namespace peerd::cluster {

// How a program ended, and what it wrote.
struct ToolEnd {
  int exit_code = 0;  // 128 and the signal's number where a signal ended it
  std::string out, err;
};

// Runs a program to its end, found as a shell finds it. It is in a process group of its own, so that Ctrl-C in a
// terminal does not reach it. The error says why it could not be started.
[[nodiscard]] Result<ToolEnd> run_tool(const std::vector<std::string>& command);

// The words of a line as a shell splits it: at blanks that neither "double" nor 'single' quotes protect, nor a
// backslash. Nothing is expanded. The error is a quote without its end.
[[nodiscard]] Result<std::vector<std::string>> split_words(const std::string& line);

}  // namespace peerd::cluster
