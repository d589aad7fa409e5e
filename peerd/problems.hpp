#pragma once
#include <cstddef>
#include <iosfwd>
#include <string>

#include "core/vrml/reader.hpp"

namespace peerd {

inline constexpr std::size_t kShownProblems = 20;  // of errors and of warnings, each

struct ProblemCount {
  std::size_t errors = 0, warnings = 0;
};

// A world's problems as FILE:LINE:COLUMN with a caret: the first kShownProblems of either kind. Errors and warnings
// apart, so that many of the one don't hide the other.
ProblemCount print_problems(const ReadResult& result, std::ostream& err);

// "1 error", "2 errors".
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

}  // namespace peerd
