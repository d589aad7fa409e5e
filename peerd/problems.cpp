#include "peerd/problems.hpp"

#include <ostream>

namespace peerd {

ProblemCount print_problems(const ReadResult& result, std::ostream& err) {
  ProblemCount count;
  for (const Diagnostic& d : result.diagnostics) {
    std::size_t& of_its_kind = d.severity == Severity::kError ? count.errors : count.warnings;
    if (++of_its_kind <= kShownProblems) err << render(result, d);
  }
  return count;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

}  // namespace peerd
