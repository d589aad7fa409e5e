#include "peerd/cli/shell/print.hpp"

#include <iostream>

#include "peerd/cli/shell/error_json.hpp"

namespace peerd {
namespace {

// Set once, before anything fails: the form of errors is that of the program's whole output.
bool errors_as_json = false;

}  // namespace

void print_errors_as_json(bool json) { errors_as_json = json; }

int failed(const InputError& error) {
  if (errors_as_json) print_error_json(error_json(error), std::cout);
  std::cerr << error.text << (error.text.ends_with('\n') ? "" : "\n");
  return error.exit_code;
}

void print_warnings(std::span<const std::string> warnings) {
  for (const std::string& warning : warnings) std::cerr << warning << '\n';
}

}  // namespace peerd
