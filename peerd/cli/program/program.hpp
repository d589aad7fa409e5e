#pragma once
#include "peerd/cli/program/lab_runs.hpp"

namespace peerd {

// The program: reads the command line and runs its command. Whatever ends it is said in one sentence. Returns the exit
// code.
[[nodiscard]] int run_program(int argc, char** argv, const LabRuns& lab);

}  // namespace peerd
