#include "peerd/cli/shell/problems.hpp"

#include <cstdio>
#include <iostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/cli/shell/error_json.hpp"

namespace peerd {

ProblemCount print_problems(const ReadResult& result, std::ostream& err) {
  ProblemCount count;
  for (const Diagnostic& d : result.diagnostics) {
    std::size_t& of_its_kind = d.severity == Severity::kError ? count.errors : count.warnings;
    if (++of_its_kind <= kShownProblems) err << render(result, d);
  }
  return count;
}

Result<std::unique_ptr<const WorldFile>> read_world_asked_for(const std::string& path, const WorldReading& reading) {
  if (path != "-") return read_world_file(path, reading);
  auto world = read_world_stream(std::cin, reading);
  if (std::ferror(stdin) == 0) return world;
  return std::unexpected(InputError{"<stdin>: error: can't be read; is it closed, or a folder?", kSystemFailed});
}

int print_error(const InputError& error, std::ostream& err, std::ostream* json) {
  err << error.text << (error.text.ends_with('\n') ? "" : "\n");
  if (json != nullptr) print_error_json(error_json(error), *json);
  return error.exit_code;
}

std::expected<std::unique_ptr<const WorldFile>, int> open_world(const std::string& path, const WorldReading& reading,
                                                                std::ostream& err, std::ostream* json) {
  WorldReading mapping = reading;
  mapping.maps_hierarchies = true;
  auto file = read_world_asked_for(path, mapping);
  if (!file) return std::unexpected(print_error(file.error(), err, json));
  const ReadResult& reported = (*file)->reported();
  print_problems(reported, err);
  if ((*file)->result.scene) return std::move(*file);
  err << lenient_advice(reported);
  if (json != nullptr) print_error_json(error_json(reported), *json);
  return std::unexpected(1);
}

}  // namespace peerd
