#pragma once
#include <span>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd {

// Says whether failed() prints errors for programs, too: as the JSON object of error_json, on standard output.
void print_errors_as_json(bool json);

// Prints the error for a person and gives its exit code.
[[nodiscard]] int failed(const InputError& error);

// Prints one line each on standard error.
void print_warnings(std::span<const std::string> warnings);

}  // namespace peerd
