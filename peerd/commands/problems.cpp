#include "peerd/commands/problems.hpp"

#include <ostream>
#include <utility>

namespace peerd {

ProblemCount print_problems(const ReadResult& result, std::ostream& err) {
  ProblemCount count;
  for (const Diagnostic& d : result.diagnostics) {
    std::size_t& of_its_kind = d.severity == Severity::kError ? count.errors : count.warnings;
    if (++of_its_kind <= kShownProblems) err << render(result, d);
  }
  return count;
}

std::expected<std::unique_ptr<const config::WorldFile>, int> open_world(const std::string& path,
                                                                        const config::WorldReading& reading,
                                                                        std::ostream& err) {
  auto file = config::read_world_file(path, reading);
  if (!file) {
    err << file.error().text << '\n';
    return std::unexpected(file.error().exit_code);
  }
  print_problems((*file)->result, err);
  if (!(*file)->result.scene) return std::unexpected(1);
  return std::move(*file);
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

}  // namespace peerd
