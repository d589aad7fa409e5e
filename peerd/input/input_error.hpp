#pragma once
#include <expected>
#include <string>

namespace peerd {

// Exit codes: something was found in the input; the command line or a file is wrong; the system failed.
inline constexpr int kFinding = 1, kWrongUse = 2, kSystemFailed = 3;

// An error that a person made or can mend, as one sentence: what is wrong, where (FILE:LINE:COLUMN: error: sentence)
// and what to do.
struct InputError {
  std::string text;
  int exit_code = kWrongUse;
};

template <class T>
using Result = std::expected<T, InputError>;

}  // namespace peerd
