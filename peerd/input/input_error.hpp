#pragma once
#include <expected>
#include <string>

namespace peerd {

// An error that a person made or can mend, as one sentence: what is wrong, where (FILE:LINE:COLUMN: error: sentence)
// and what to do.
struct InputError {
  std::string text;
  int exit_code = 2;  // 1: a finding about the input, 2: wrong use or configuration, 3: the environment
};

template <class T>
using Result = std::expected<T, InputError>;

}  // namespace peerd
