// The program `peerd`.
#include <span>

#include "peerd/cli/program/program.hpp"

int main(int argc, char** argv) {
  return peerd::run_program(argc, argv, peerd::runs_of_other_program(std::span(argv, static_cast<std::size_t>(argc))));
}
